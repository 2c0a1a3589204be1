#include "dialog_manager/trace.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace manager {
namespace {

using namespace objdb;

std::string quoted_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

// the words of a value are its cells; a text, a name or an array of them is one
std::vector<std::string> cells_of(const Field& field, const Value& value, const Names& names) {
  std::string text;
  append_value(text, field, value, names);
  const bool numbers =
      field.kind == Kind::real || field.kind == Kind::vec3 || field.kind == Kind::quat || field.kind == Kind::integer;
  if (!numbers || (field.array && text == "-"))
    return {field.kind == Kind::text && !field.array ? std::get<std::string>(value) : text};
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t blank = std::min(text.find(' ', at), text.size());
    out.push_back(text.substr(at, blank - at));
    at = blank + 1;
  }
  return out;
}

std::string unit_suffix(const Field& field, std::size_t element) {
  std::string unit = si_name(field.dimension(static_cast<int>(element)));
  for (char& c : unit)
    if (c == '/' || c == '*') c = '_';
  std::erase(unit, '^');
  return unit.empty() ? "" : "_" + unit;
}

}  // namespace

Result<std::unique_ptr<Trace>> Trace::open(const std::string& path, const Database& world, Words patterns,
                                           const Scope& scope, double time, double period) {
  std::unique_ptr<Trace> trace(new Trace);
  trace->path_ = path;
  for (const Word& word : patterns) {
    const Result<Target> target = parse_target(word);
    if (!target) return target.error();
    const Result<std::vector<const Object*>> objects = find_objects(world, target->pattern, word.column, scope);
    if (!objects) return objects.error();
    const std::size_t before = trace->columns_.size();
    for (const Object* object : *objects)
      for (int i = 0; i < static_cast<int>(object->slots.size()); ++i)
        if (target->field.empty() || matches(target->field, object->type->field(i).name))
          trace->columns_.push_back({object->id, i});
    if (trace->columns_.size() == before)
      return Error{ErrorKind::unknown,
                   "no object that fits " + std::string(target->pattern) + " has a field " + std::string(target->field),
                   target->field_column};
  }
  // a pipe that nobody reads is an error, not something to wait for
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, 0666);
  trace->file_ = file < 0 ? nullptr : ::fdopen(file, "w");
  if (trace->file_ == nullptr) return Error{ErrorKind::io, path + " cannot be written: " + std::strerror(errno), 0};
  trace->start_ = time;
  trace->period_ = period;
  for (const Status& written : {trace->header(world), trace->row(world, time)})
    if (!written) return written.error();
  if (std::fflush(trace->file_) != 0)
    return Error{ErrorKind::io, path + " cannot be written: " + std::strerror(errno), 0};
  return trace;
}

Status Trace::write(const std::string& line) {
  if (std::fprintf(file_, "%s\n", line.c_str()) >= 0) return {};
  return Error{ErrorKind::io, path_ + " cannot be written: " + std::strerror(errno), 0};
}

Trace::~Trace() {
  if (file_ != nullptr) std::fclose(file_);
}

Status Trace::header(const Database& world) {
  static constexpr const char* axes[] = {"x", "y", "z"};
  static constexpr const char* parts[] = {"w", "x", "y", "z"};
  std::string line = "t_s";
  for (const Column& column : columns_) {
    const Object& object = *world.object(column.object);
    const Field& field = object.type->field(column.field);
    const std::size_t cells = cells_of(field, world.value(object, column.field), world).size();
    cells_.push_back(cells);
    for (std::size_t i = 0; i < cells; ++i) {
      const auto each = static_cast<std::size_t>(words_of(field.kind));
      line += "," + object.path + "." + field.name;
      if (field.array && cells > 1) line += "_" + std::to_string(i / each);
      if (each == 3) line += std::string("_") + axes[i % 3];
      if (each == 4) line += std::string("_") + parts[i % 4];
      line += unit_suffix(field, i / each);
    }
  }
  return write(line);
}

Status Trace::row(const Database& world, double time) {
  std::string line;
  append_number(line, time);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Object* object = world.object(columns_[c].object);
    std::vector<std::string> cells;
    if (object != nullptr)
      cells = cells_of(object->type->field(columns_[c].field), world.value(*object, columns_[c].field), world);
    // an array that grew or shrank still fills its columns
    cells.resize(cells_[c]);
    for (const std::string& cell : cells) line += "," + quoted_cell(cell);
  }
  ++rows_;
  return write(line);
}

Status Trace::tick(const Database& world, double time) {
  if (period_ > 0 && time < start_ + static_cast<double>(rows_) * period_ - 1e-9) return {};
  return row(world, time);
}

}  // namespace manager
