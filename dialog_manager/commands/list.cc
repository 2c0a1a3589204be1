#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Database& world = call.manager.world;
  if (call.words.empty()) {
    world.for_each(call.scope.resolve("**"), [&](const Object& object) { call.out += object.path + "\n"; });
    return {};
  }
  const Result<Target> target = parse_target(call.words[0]);
  if (!target) return target.error();
  if (!target->field.empty())
    return Error{ErrorKind::syntax, "list takes paths without fields, expected PATTERN", target->field_column};
  const Result<std::vector<const Object*>> objects =
      find_objects(world, target->pattern, call.words[0].column, call.scope);
  if (!objects) return objects.error();
  for (const Object* object : *objects) call.out += object->path + "\n";
  return {};
}

}  // namespace

extern const Command command_list;
const Command command_list = {
    "list", "[PATTERN]", "Prints the paths of all objects, or of those that fit.", Effect::look, 0, 1, run};

}  // namespace manager
