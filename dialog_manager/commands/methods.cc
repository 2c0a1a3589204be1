#include <algorithm>

#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  static constexpr std::string_view parts[] = {"method",         "method_used", "chosen", "predicted_error",
                                               "predicted_time", "status",      "elapsed"};
  const Database& world = call.manager.world;
  const std::string pattern = call.words.empty() ? "**" : std::string(call.words[0].text);
  std::vector<const Object*> objects;
  if (call.words.empty()) {
    world.for_each("**", [&](const Object& object) { objects.push_back(&object); });
  } else {
    const Result<std::vector<const Object*>> found = find_objects(world, pattern, call.words[0].column, call.scope);
    if (!found) return found.error();
    objects = *found;
  }
  for (const Object* object : objects) {
    if (object->type->find("method") < 0) continue;
    call.out += object->path;
    for (int i = 0; i < static_cast<int>(object->slots.size()); ++i) {
      const Field& field = object->type->field(i);
      if (std::find(std::begin(parts), std::end(parts), field.name) == std::end(parts) &&
          !field.name.ends_with("_error"))
        continue;
      call.out += " " + field.name + "=";
      append_value(call.out, field, world.value(*object, i), world);
      call.out += field.unit();
    }
    call.out += "\n";
  }
  return {};
}

}  // namespace

extern const Command command_methods;
const Command command_methods = {"methods",
                                 "[PATTERN]",
                                 "Prints, for every object with a method: the method wanted and used (or chosen), the "
                                 "errors and the time, predicted "
                                 "where it has a chart of its methods, and achieved.",
                                 Effect::look,
                                 0,
                                 1,
                                 run};

}  // namespace manager
