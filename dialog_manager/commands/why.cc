#include <algorithm>

#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

// a line that creates an object and does not speak of this field
bool made_silently(std::string_view line, std::string_view field) {
  LineWords words;
  if (!words.split(line) || words.empty() || words.words()[0].text != "create") return false;
  const Words all = words.words();
  return std::none_of(all.begin() + 1, all.end(), [&](const Word& word) { return word.text == field; });
}

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
  // what made the object made this value too, without a word about it
  if (line && made_silently(*line, field.name)) out += "    the default of " + field.owner->name() + ",\n";
  out += line ? ": " + std::string(*line) + "\n" : " (the line is no longer kept)\n";
}

// somebody gave it this value
bool was_said(const Manager& manager, const Object& object, int index) {
  const Field& field = object.type->field(index);
  const std::uint64_t said = object.slots[static_cast<std::size_t>(index)].origin.line;
  const std::optional<std::string_view> line = manager.lines.find(said);
  return said != 0 && !field.derived && !(line && made_silently(*line, field.name));
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
  const Result<const Object*> found = find_object(manager.world, *target, call.scope);
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
      if (was_said(manager, object, i)) tell_origin(call.out, manager, object, i);
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
