#include "manipulators/render/world_file.h"

#include <fstream>

#include "objdb/statement.h"

namespace render {

namespace {

objdb::Status take_line(std::string_view line, objdb::Database& world) {
  objdb::LineWords words;
  if (objdb::Status split = words.split(line); !split) return split;
  if (words.empty()) return {};
  const std::string_view verb = words.words()[0].text;
  const objdb::Words rest = words.words().subspan(1);
  if (verb == "type") {
    auto type = world.declare_type(rest);
    return type ? objdb::Status() : objdb::Status(type.error());
  }
  if (verb == "field") {
    auto field = world.declare_field(rest);
    return field ? objdb::Status() : objdb::Status(field.error());
  }
  if (verb == "create") {
    auto object = objdb::create_statement(world, rest, {});
    return object ? objdb::Status() : objdb::Status(object.error());
  }
  if (verb == "set") return objdb::set_statement(world, rest, {});
  return {};
}

std::string complaint(const std::string& where, int line, const objdb::Error& error) {
  return where + ":" + std::to_string(line) + ":" + std::to_string(std::max(error.column, 1)) + ": error " +
         std::string(objdb::name_of(error.kind)) + " " + error.sentence;
}

}  // namespace

std::string read_world(const std::string& path, objdb::Database& world) {
  std::ifstream file(path);
  if (!file) return path + ":1:1: error io cannot be read";
  std::string line, whole;
  int number = 0;
  int first = 1;
  while (std::getline(file, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    // a backslash at the end joins the next line
    if (!line.empty() && line.back() == '\\') {
      if (whole.empty()) first = number;
      whole += line.substr(0, line.size() - 1);
      continue;
    }
    if (whole.empty()) first = number;
    whole += line;
    if (objdb::Status status = take_line(whole, world); !status) return complaint(path, first, status.error());
    whole.clear();
  }
  return {};
}

std::string declare_types(std::string_view text, objdb::Database& world) {
  int number = 0;
  while (!text.empty()) {
    ++number;
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.starts_with("type ") && !line.starts_with("field ")) continue;
    if (objdb::Status status = take_line(line, world); !status) return complaint("declaration", number, status.error());
  }
  return {};
}

}  // namespace render
