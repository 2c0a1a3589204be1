#include <algorithm>

#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

// a run of elements, or one component of a vec3 or quat
Status append_slice(std::string& out, const Database& world, const Object& object, int index, const Target& target) {
  const Field& field = object.type->field(index);
  const Value value = world.value(object, index);
  std::vector<std::string> parts;
  if (field.array) {
    for (std::size_t i = target.first; i <= target.last && i < element_count(field, value); ++i)
      append_element(parts.emplace_back(), field, value, i, world);
  } else {
    std::string text;
    append_value(text, field, value, world);
    std::vector<std::string> words;
    for (std::size_t at = 0; words_of(field.kind) > 1 && at <= text.size();) {
      const std::size_t blank = std::min(text.find(' ', at), text.size());
      words.push_back(text.substr(at, blank - at));
      at = blank + 1;
    }
    for (std::size_t i = target.first; i <= target.last && i < words.size(); ++i) parts.push_back(words[i]);
  }
  if (parts.size() != target.last - target.first + 1)
    return Error{ErrorKind::range,
                 object.path + "." + field.name + " has no element " + std::to_string(target.first + parts.size()),
                 target.field_column};
  for (std::size_t i = 0; i < parts.size(); ++i) out += (i == 0 ? "" : " ") + parts[i];
  return {};
}

Outcome run(Call& call) {
  const Database& world = call.manager.world;
  const Result<Target> target = parse_target(call.words[0]);
  if (!target) return target.error();
  const Result<std::vector<const Object*>> objects =
      find_objects(world, target->pattern, call.words[0].column, call.scope);
  if (!objects) return objects.error();
  const bool one = !is_pattern(target->pattern) && !target->field.empty() && !is_pattern(target->field);
  if (one) {
    const Object& object = *objects->front();
    const Result<int> index = find_field(object, target->field, target->field_column);
    if (!index) return index.error();
    if (target->sliced) {
      if (Status status = append_slice(call.out, world, object, *index, *target); !status) return status;
    } else {
      append_value(call.out, object.type->field(*index), world.value(object, *index), world);
    }
    call.out += '\n';
    return {};
  }
  const std::size_t before = call.out.size();
  bool any = false;
  for (const Object* object : *objects)
    for (int i = 0; i < static_cast<int>(object->slots.size()); ++i) {
      const Field& field = object->type->field(i);
      if (!target->field.empty() && !matches(target->field, field.name)) continue;
      any = true;
      call.out += object->path + "." + field.name + " ";
      if (target->sliced) {
        if (Status status = append_slice(call.out, world, *object, i, *target); !status) {
          call.out.resize(before);
          return status;
        }
      } else {
        append_value(call.out, field, world.value(*object, i), world);
      }
      call.out += '\n';
    }
  if (!any)
    return Error{ErrorKind::unknown,
                 "no object that fits " + std::string(target->pattern) + " has a field " + std::string(target->field),
                 target->field_column};
  return {};
}

}  // namespace

extern const Command command_get;
const Command command_get = {
    "get",
    "PATTERN[.FIELD]",
    "Prints the value of a field; with a pattern, or without a field, a line PATH.FIELD VALUE for each.",
    Effect::look,
    1,
    1,
    run};

}  // namespace manager
