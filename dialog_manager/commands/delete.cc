#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

// a program deletes what it may make, and nothing that stands below that
Status may_delete(const Call& call) {
  if (call.words.size() > 1)
    return call.error(1, ErrorKind::owner, "a program cannot empty the references of others, expected delete PATTERN");
  const Result<Target> target = parse_target(call.words[0]);
  if (!target) return target.error();
  Database& world = call.manager.world;
  const Result<std::vector<const Object*>> objects =
      find_objects(world, target->pattern, call.words[0].column, call.scope);
  if (!objects) return objects.error();
  Status may;
  const auto check = [&](const Object& object) {
    if (may) may = call.source.gate->may_make(object);
  };
  for (const Object* object : *objects) {
    check(*object);
    world.for_each(object->path + "/**", check);
  }
  return may ? Status() : call.error(0, may.error().kind, may.error().sentence);
}

Outcome run(Call& call) {
  if (call.source.gate != nullptr)
    if (Status may = may_delete(call); !may) return may;
  return delete_statement(call.manager.world, call.words, call.scope);
}

}  // namespace

extern const Command command_delete;
const Command command_delete = {
    "delete",
    "PATTERN [force]",
    "Deletes objects and everything below them. What others refer to is kept, unless force empties their references.",
    Effect::change,
    1,
    2,
    run};

}  // namespace manager
