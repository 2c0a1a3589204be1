#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

#include <nlohmann/json.hpp>
namespace manager {
namespace {

using namespace objdb;

using Json = nlohmann::ordered_json;

Json json_integer(const Field& field, std::int64_t value, const Names& names) {
  switch (field.kind) {
    case Kind::boolean: return value != 0;
    case Kind::word: return field.words[static_cast<std::size_t>(value)];
    case Kind::ref: return value == 0 ? Json(nullptr) : Json(std::string(names.path(static_cast<ObjectId>(value))));
    default: return value;
  }
}

Json json_value(const Field& field, const Value& value, const Names& names) {
  return std::visit(
      [&](const auto& each) -> Json {
        using T = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<T, std::int64_t>) {
          return json_integer(field, each, names);
        } else if constexpr (std::is_same_v<T, std::vector<std::int64_t>>) {
          Json out = Json::array();
          for (const std::int64_t one : each) out.push_back(json_integer(field, one, names));
          return out;
        } else if constexpr (std::is_same_v<T, Numbers>) {
          // vec3[] and quat[] as arrays of arrays
          const auto size = static_cast<std::size_t>(words_of(field.kind));
          if (size == 1) return each.vector();
          Json out = Json::array();
          for (auto first = each.begin(); first != each.end(); first += static_cast<std::ptrdiff_t>(size))
            out.push_back(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(size)));
          return out;
        } else {
          return each;
        }
      },
      value);
}

Outcome run(Call& call) {
  if (call.words[0].text != "--json") return call.error(0, ErrorKind::syntax, "expected print --json PATTERN");
  const Database& world = call.manager.world;
  const Result<Target> target = parse_target(call.words[1]);
  if (!target) return target.error();
  const Result<std::vector<const Object*>> objects =
      find_objects(world, target->pattern, call.words[1].column, call.scope);
  if (!objects) return objects.error();
  Json out = Json::object();
  bool any = false;
  for (const Object* object : *objects) {
    Json fields = Json::object();
    fields["type"] = object->type->name();
    for (int i = 0; i < static_cast<int>(object->slots.size()); ++i) {
      const Field& field = object->type->field(i);
      if (!target->field.empty() && !matches(target->field, field.name)) continue;
      any = true;
      fields[field.name] = json_value(field, world.value(*object, i), world);
    }
    out[object->path] = std::move(fields);
  }
  if (!any && !target->field.empty())
    return Error{ErrorKind::unknown,
                 "no object that fits " + std::string(target->pattern) + " has a field " + std::string(target->field),
                 target->field_column};
  call.out += out.dump() + "\n";
  return {};
}

}  // namespace

extern const Command command_print;
const Command command_print = {"print",
                               "--json PATTERN[.FIELD]",
                               "Prints objects as one JSON text: {PATH: {type: TYPE, FIELD: VALUE, ...}, ...}.",
                               Effect::look,
                               2,
                               2,
                               run};

}  // namespace manager
