#include <algorithm>

#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

void tell_origin(std::string& out, const Manager& manager, const Object& object, int index) {
  const Field& field = object.type->field(index);
  out += object.path + "." + field.name + " ";
  append_value(out, field, manager.world.value(object, index), manager.world);
  out += "\n";
  if (field.derived) {
    out += "    computed from the frames above it\n";
    return;
  }
  const Origin& origin = object.slots[static_cast<std::size_t>(index)].origin;
  if (origin.line == 0) {
    out += "    the default of " + field.owner->name() + "." + field.name + "\n";
    return;
  }
  out += "    by " + manager.source_name(origin.source) + " at tick " + std::to_string(origin.tick);
  const std::optional<std::string_view> line = manager.lines.find(origin.line);
  out += line ? ": " + std::string(*line) + "\n" : " (the line is no longer kept)\n";
}

// what a solver says about its own answer
bool is_report(const Field& field) {
  static constexpr std::string_view names[] = {"status",     "reason",  "limits", "active_limits",
                                               "iterations", "elapsed", "method", "cost"};
  return std::find(std::begin(names), std::end(names), field.name) != std::end(names) || field.name.ends_with("_error");
}

Outcome run(Call& call) {
  const Manager& manager = call.manager;
  const Result<Target> target = parse_target(call.words[0]);
  if (!target) return target.error();
  const Result<const Object*> found =
      find_object(manager.world, {target->pattern, call.words[0].column, false}, call.scope);
  if (!found) return found.error();
  const Object& object = **found;
  if (!target->field.empty()) {
    const Result<int> index = find_field(object, target->field, target->field_column);
    if (!index) return index.error();
    tell_origin(call.out, manager, object, *index);
  }
  // what its manipulator reports; of an object that nobody reports on, who wrote each value
  bool reported = false;
  for (int i = 0; i < static_cast<int>(object.slots.size()); ++i) {
    const Field& field = object.type->field(i);
    if (!is_report(field)) continue;
    reported = true;
    call.out += "    " + field.name + " ";
    append_value(call.out, field, manager.world.value(object, i), manager.world);
    const std::string unit = field.unit();
    call.out += (unit.empty() ? "" : " " + unit) + "\n";
  }
  if (target->field.empty() && !reported)
    for (int i = 0; i < static_cast<int>(object.slots.size()); ++i)
      if (object.slots[static_cast<std::size_t>(i)].origin.line != 0) tell_origin(call.out, manager, object, i);
  return {};
}

}  // namespace

extern const Command command_why;
const Command command_why = {"why",
                             "PATH[.FIELD]",
                             "Tells who wrote a value, at which tick, by which line, and what its manipulator "
                             "reported: status, reason, limits, error, cost.",
                             Effect::look,
                             1,
                             1,
                             run};

}  // namespace manager
