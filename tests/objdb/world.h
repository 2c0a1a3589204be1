#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "objdb/statement.h"

/// A world that is spoken to in lines, as the manager and a mirror do it.
namespace objdb {

class World {
 public:
  Database database;

  /// Says one line. "" when it was accepted, else "KIND COLUMN sentence".
  std::string say(std::string_view line, const Scope& scope = {}) {
    if (Status split = words_.split(line); !split) return told(split.error());
    if (words_.empty()) return {};
    const std::string_view verb = words_.words()[0].text;
    const Words rest = words_.words().subspan(1);
    const auto result = [](const auto& outcome) { return outcome ? std::string() : told(outcome.error()); };
    if (verb == "type") return result(database.declare_type(rest));
    if (verb == "field") return result(database.declare_field(rest));
    if (verb == "create") return result(create_statement(database, rest, scope));
    if (verb == "set") return result(set_statement(database, rest, scope));
    if (verb == "delete") return result(delete_statement(database, rest, scope));
    return "unknown 1 no such verb";
  }

  /// Says many lines; the first refusal, with its line, or "".
  std::string read(std::string_view script) {
    while (!script.empty()) {
      const std::size_t end = script.find('\n');
      const std::string_view line = script.substr(0, end);
      if (line.size() >= longest_line) return "a line of " + std::to_string(line.size()) + " bytes";
      if (const std::string told = say(line); !told.empty()) return std::string(line.substr(0, 200)) + " -> " + told;
      script.remove_prefix(end == std::string_view::npos ? script.size() : end + 1);
    }
    return {};
  }

  /// The value of "PATH.FIELD" as it is printed.
  std::string get(std::string_view name) const {
    const std::size_t dot = name.find('.');
    const Object* object = database.find(name.substr(0, dot));
    if (object == nullptr) return "no object";
    const int field = object->type->find(name.substr(dot + 1));
    if (field < 0) return "no field";
    std::string out;
    append_value(out, object->type->field(field), database.value(*object, field), database);
    return out;
  }

  /// Everything that can be asked about the values of the world, measured and derived ones too, by path.
  std::string everything() const {
    std::string out;
    database.for_each("**", [&](const Object& object) {
      for (int i = 0; i < static_cast<int>(object.slots.size()); ++i) {
        out += object.path + "." + object.type->field(i).name + " ";
        append_value(out, object.type->field(i), database.value(object, i), database);
        out += '\n';
      }
    });
    return out;
  }

 private:
  static std::string told(const Error& error) {
    return std::string(name_of(error.kind)) + " " + std::to_string(error.column) + " " + error.sentence;
  }

  LineWords words_;
};

}  // namespace objdb
