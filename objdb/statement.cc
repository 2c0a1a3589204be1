#include "objdb/statement.h"

#include <algorithm>
#include <array>

namespace objdb {
namespace {

// a line stays well below the limit of a channel, 64 KiB
constexpr std::size_t longest_set = 48 * 1024;

Error error_at(int column, ErrorKind kind, std::string sentence) { return {kind, std::move(sentence), column}; }

Status parse_slice(Target& target, std::string_view text, int column) {
  // "[3]" or "[0..9]"
  const auto bad = [&] {
    return error_at(column, ErrorKind::syntax, shown(text) + " is no element, expected [3] or [0..9]");
  };
  if (text.size() < 3 || text.back() != ']') return bad();
  const std::string_view inside = text.substr(1, text.size() - 2);
  const std::size_t dots = inside.find("..");
  const Result<std::int64_t> first = parse_integer(inside.substr(0, dots));
  const Result<std::int64_t> last = dots == std::string_view::npos ? first : parse_integer(inside.substr(dots + 2));
  if (!first || !last || *first < 0 || *last < *first) return bad();
  target.sliced = true;
  target.first = static_cast<std::size_t>(*first);
  target.last = static_cast<std::size_t>(*last);
  return {};
}

// the value of a vec3 or quat after some of its components were replaced
Result<Value> replace_components(const Object& object, const Field& field, const Target& target, Words words,
                                 const Names& names) {
  const auto size = static_cast<std::size_t>(words_of(field.kind));
  if (target.last >= size)
    return error_at(target.field_column, ErrorKind::range,
                    field.name + " has " + std::to_string(size) + " components, no component " +
                        std::to_string(std::max(target.first, size)));
  if (const std::size_t count = target.last - target.first + 1; words.size() != count)
    return error_at(target.column, ErrorKind::syntax,
                    field.name + ": expected " + std::to_string(count) + (count == 1 ? " word" : " words") + ", got " +
                        std::to_string(words.size()));
  std::string said;
  append_value(said, field, object.value(object.type->find(field)), names);
  LineWords old;
  if (Status split = old.split(said); !split) return split.error();
  std::vector<Word> all(old.words().begin(), old.words().end());
  // what stays is what it was, and is not to blame
  for (Word& word : all) word.column = target.field_column;
  std::copy(words.begin(), words.end(), all.begin() + static_cast<std::ptrdiff_t>(target.first));
  return parse_value(field, all, names);
}

// the value of a field after some of its elements were replaced
Result<Value> replace_elements(const Object& object, const Field& field, const Target& target, Words words,
                               const Names& names) {
  if (!field.array && words_of(field.kind) > 1) return replace_components(object, field, target, words, names);
  if (!field.array)
    return error_at(target.field_column, ErrorKind::type, field.name + " is a " + field.kind_text() + ", not an array");
  const Value& old = object.value(object.type->find(field));
  const std::size_t size = element_count(field, old), count = target.last - target.first + 1;
  const bool grows = field.count == Field::any_length;
  if (target.first > size || (!grows && target.last >= size))
    return error_at(target.field_column, ErrorKind::range,
                    field.name + " has " + std::to_string(size) + " elements, no element " +
                        std::to_string(target.first > size ? target.first : target.last));
  const auto each = static_cast<std::size_t>(words_of(field.kind));
  if (words.size() % each != 0 || words.size() / each != count)
    return error_at(target.column, ErrorKind::syntax,
                    field.name + ": " + std::to_string(count) + (count == 1 ? " element takes " : " elements take ") +
                        std::to_string(each) + (each == 1 ? " word" : " words") + " each, got " +
                        std::to_string(words.size()));
  Field part;
  part.name = field.name;
  part.kind = field.kind;
  part.array = true;
  part.count = static_cast<int>(count);
  part.ref_type = field.ref_type;
  part.words = field.words;
  part.ranged = field.ranged;
  part.low = field.low;
  part.high = field.high;
  part.dimensions = field.dimensions;
  if (part.dimensions.size() > 1)
    part.dimensions = {&field.dimensions[target.first], &field.dimensions[target.last] + 1};
  const Result<Value> parsed = parse_value(part, words, names);
  if (!parsed) return parsed.error();
  Value value = old;
  const auto replace = [&](auto& elements, const auto& fresh) {
    elements.resize(std::max(elements.size(), (target.last + 1) * each));
    std::copy(fresh.begin(), fresh.end(), elements.begin() + static_cast<std::ptrdiff_t>(target.first * each));
  };
  std::visit(
      [&](auto& elements) {
        using T = std::decay_t<decltype(elements)>;
        if constexpr (std::is_same_v<T, Numbers>) {
          std::vector<double> changed = elements.vector();
          replace(changed, std::get<T>(*parsed));
          elements = Numbers(std::move(changed));
        } else if constexpr (std::is_same_v<T, std::vector<std::int64_t>> ||
                             std::is_same_v<T, std::vector<std::string>>) {
          replace(elements, std::get<T>(*parsed));
        }
      },
      value);
  return value;
}

// every value must fit the line that says it, also where its path is longer or its text needs quotes
Status check_length(std::string_view path, const Field& field, const Value& value) {
  const auto check = [&](const std::string& text) -> Status {
    if (text.size() < longest_line / 2 - 2 * longest_path) return {};
    const std::size_t line = std::string_view("set . \n").size() + path.size() + field.name.size() +
                             quote(text).size() + (field.array ? std::string_view("[1000000]").size() : 0);
    if (line <= longest_line) return {};
    return Error{ErrorKind::limit,
                 field.name + ": the line that says this value would have " + std::to_string(line) +
                     " bytes, expected at most " + std::to_string(longest_line),
                 0};
  };
  if (const auto* text = std::get_if<std::string>(&value)) return check(*text);
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value))
    for (const std::string& each : *texts)
      if (Status status = check(each); !status) return status;
  return {};
}

Status parse_for(const Database& database, const Object& object, int index, const Target& target, Words words,
                 const Names& names, const Word& where, Value& out) {
  const Field& field = object.type->field(index);
  if (field.derived)
    return error_at(where.column, ErrorKind::owner,
                    object.path + "." + field.name + " is computed from other fields and cannot be set");
  Status parsed;
  if (target.sliced) {
    Result<Value> value = replace_elements(object, field, target, words, names);
    if (value)
      out = std::move(*value);
    else
      parsed = value.error();
  } else {
    parsed = parse_value_into(field, words, names, out);
  }
  if (!parsed) {
    Error error = parsed.error();
    if (error.column == 0) error.column = where.column;
    return error;
  }
  if (field.kind == Kind::text)
    if (Status status = check_length(object.path, field, out); !status)
      return error_at(words[0].column, status.error().kind, status.error().sentence);
  // text is checked as it is read; only references can still be wrong
  if (field.holds_refs())
    if (Status status = database.check(object, index, out); !status)
      return error_at(words[0].column, status.error().kind, status.error().sentence);
  return {};
}

// the usual target: a field of an object, both there under just these names
const Object* find_plain(const Database& database, std::string_view target, const Scope& scope, int& field) {
  const std::size_t dot = target.find('.');
  if (dot == std::string_view::npos) return nullptr;
  const std::string_view path = target.substr(0, dot);
  const Object* object = scope.prefix.empty() ? database.find(path) : database.find(scope.resolve(path));
  if (object != nullptr) field = object->type->find(target.substr(dot + 1));
  return field >= 0 ? object : nullptr;
}

Status set_one(Database& database, const Object& object, int field, const Target& target, Words words,
               const Names& names, Gate* gate) {
  const Word& where = words[0];
  if (gate != nullptr)
    if (Status status = gate->may_write(object, field); !status)
      return error_at(where.column, status.error().kind, status.error().sentence);
  Value value;
  if (Status parsed = parse_for(database, object, field, target, words.subspan(1), names, where, value); !parsed)
    return parsed;
  database.assign(object, field, std::move(value));
  return {};
}

void append_declarations(std::string& out, const Schema& schema) {
  // a second schema tells what is built in
  static const Schema pristine;
  for (const auto& type : schema.types()) {
    if (schema.is_built_in(*type)) continue;
    out += "type " + type->name();
    if (type->base() != nullptr) out += " extends " + type->base()->name();
    if (!type->doc().empty()) {
      const std::string doc = quote(type->doc());
      out += doc[0] == '"' ? " " + doc : " \"" + doc + "\"";
    }
    out += '\n';
  }
  for (const auto& type : schema.types())
    for (const Field* field : type->fields()) {
      if (field->owner != type.get()) continue;
      const Type* known = pristine.find(type->name());
      if (known != nullptr && known->find(field->name) >= 0) continue;
      out += field->declaration() + '\n';
    }
}

}  // namespace

Result<ObjectId> ScopedNames::object(const Word& word, const Type* type) const {
  if (!scope_.prefix.empty()) {
    const std::string inner = scope_.resolve(word.text);
    if (const Object* found = database_.find(inner)) {
      if (type == nullptr || found->type->is(*type)) return found->id;
      return database_.object({inner, word.column, word.quoted}, type);
    }
  }
  return database_.object(word, type);
}

Result<Target> parse_target(const Word& word) {
  Target target;
  target.column = word.column;
  std::string_view text = word.text;
  const std::size_t dot = text.find('.');
  target.pattern = text.substr(0, dot);
  if (dot != std::string_view::npos) {
    target.field = text.substr(dot + 1);
    target.field_column = word.column + static_cast<int>(dot) + 1;
    const std::size_t bracket = target.field.find('[');
    if (bracket != std::string_view::npos) {
      const std::string_view slice = target.field.substr(bracket);
      target.field = target.field.substr(0, bracket);
      if (Status status = parse_slice(target, slice, target.field_column + static_cast<int>(bracket)); !status)
        return status.error();
    }
    if (target.field.empty() || (!is_name(target.field) && !is_pattern(target.field)))
      return error_at(target.field_column, ErrorKind::syntax, shown(target.field) + " is not the name of a field");
  }
  if (target.pattern.empty()) return error_at(word.column, ErrorKind::syntax, shown(text) + " names no object");
  if (!is_pattern(target.pattern) && !is_path(target.pattern))
    return error_at(word.column, ErrorKind::syntax, shown(target.pattern) + " is not a path (names joined by '/')");
  return target;
}

Result<const Object*> find_object(const Database& database, const Word& word, const Scope& scope) {
  if (scope.prefix.empty()) {
    if (const Object* found = database.find(word.text)) return found;
  } else if (const Object* found = database.find(scope.resolve(word.text))) {
    return found;
  }
  const std::string path = scope.resolve(word.text);
  const Result<ObjectId> id = database.object({path, word.column, word.quoted}, nullptr);
  if (!id) return id.error();
  return database.object(*id);
}

Result<int> find_field(const Object& object, std::string_view field, int column) {
  const int index = object.type->find(field);
  if (index >= 0) return index;
  return error_at(
      column, ErrorKind::unknown,
      object.path + " (" + object.type->name() + ") has no field " + shown(field) + object.type->hint(field));
}

Result<std::vector<const Object*>> find_objects(const Database& database, std::string_view pattern, int column,
                                                const Scope& scope) {
  std::vector<const Object*> out;
  if (!is_pattern(pattern)) {
    const Result<const Object*> one = find_object(database, Word{pattern, column, false}, scope);
    if (!one) return one.error();
    out.push_back(*one);
    return out;
  }
  database.for_each(scope.resolve(pattern), [&](const Object& object) { out.push_back(&object); });
  if (out.empty()) return error_at(column, ErrorKind::unknown, "no object fits " + shown(pattern));
  return out;
}

Result<ObjectId> create_statement(Database& database, Words words, const Scope& scope) {
  if (words.size() < 2)
    return Error{ErrorKind::syntax, "expected create TYPE PATH {FIELD VALUE...}", words.empty() ? 0 : words[0].column};
  const Result<const Type*> type = database.schema().type(words[0]);
  if (!type) return type.error();
  const ScopedNames names(database, scope);
  const std::string path = scope.resolve(words[1].text);

  // every value is read before the object is made
  std::vector<std::pair<int, Value>> values;
  for (std::size_t at = 2; at < words.size();) {
    const Word& name = words[at++];
    const int index = name.quoted ? -1 : (*type)->find(name.text);
    if (index < 0)
      return error_at(name.column, ErrorKind::unknown,
                      (*type)->name() + " has no field " + shown(name.text) + (*type)->hint(name.text));
    const Field& field = (*type)->field(index);
    if (field.derived)
      return error_at(name.column, ErrorKind::owner, field.name + " is computed from other fields and cannot be set");
    if (std::any_of(values.begin(), values.end(), [&](const auto& each) { return each.first == index; }))
      return error_at(name.column, ErrorKind::exists, field.name + " is given twice");
    std::size_t count = 0;
    if (const int fixed = word_count(field); fixed >= 0) {
      count = std::min(words.size() - at, static_cast<std::size_t>(fixed));
    } else {
      while (at + count < words.size() && (words[at + count].quoted || (*type)->find(words[at + count].text) < 0))
        ++count;
    }
    Result<Value> value = parse_value(field, words.subspan(at, count), names);
    if (!value) {
      Error error = value.error();
      if (error.column == 0) error.column = name.column;
      return error;
    }
    if (Status status = check_length(path, field, *value); !status)
      return error_at(words[at].column, status.error().kind, status.error().sentence);
    values.emplace_back(index, std::move(*value));
    at += count;
  }

  const Result<ObjectId> id = database.create(**type, path);
  if (!id) return error_at(words[1].column, id.error().kind, id.error().sentence);
  const Object& object = *database.object(*id);
  for (auto& [index, value] : values) database.assign(object, index, std::move(value));
  return *id;
}

Status set_statement(Database& database, Words words, const Scope& scope, Gate* gate) {
  if (words.size() < 2)
    return Error{ErrorKind::syntax, "expected set PATH.FIELD VALUE...", words.empty() ? 0 : words[0].column};
  const ScopedNames names(database, scope);
  int plain_field = -1;
  if (const Object* object = find_plain(database, words[0].text, scope, plain_field))
    return set_one(database, *object, plain_field, {}, words, names, gate);
  const Result<Target> target = parse_target(words[0]);
  if (!target) return target.error();
  if (target->field.empty())
    return error_at(words[0].column, ErrorKind::syntax, shown(words[0].text) + " names no field, expected PATH.FIELD");
  if (is_pattern(target->field))
    return error_at(target->field_column, ErrorKind::syntax,
                    shown(target->field) + " is a pattern, expected one field");
  const Words values = words.subspan(1);

  if (!is_pattern(target->pattern)) {
    const Result<const Object*> object = find_object(database, *target, scope);
    if (!object) return object.error();
    const Result<int> index = find_field(**object, target->field, target->field_column);
    if (!index) return index.error();
    return set_one(database, **object, *index, *target, words, names, gate);
  }

  const Result<std::vector<const Object*>> objects = find_objects(database, target->pattern, words[0].column, scope);
  if (!objects) return objects.error();
  struct Write {
    const Object* object;
    int field;
    Value value;
  };
  std::vector<Write> writes;
  for (const Object* object : *objects) {
    const int index = object->type->find(target->field);
    if (index < 0) continue;
    if (gate != nullptr)
      if (Status status = gate->may_write(*object, index); !status)
        return error_at(words[0].column, status.error().kind, status.error().sentence);
    writes.push_back({object, index, {}});
    if (Status parsed = parse_for(database, *object, index, *target, values, names, words[0], writes.back().value);
        !parsed)
      return parsed;
  }
  if (writes.empty())
    return error_at(target->field_column, ErrorKind::unknown,
                    "no object that fits " + shown(target->pattern) + " has a field " + std::string(target->field));
  // several parents at once may close a circle that none closes alone: check again as they are written
  for (std::size_t i = 0; i < writes.size(); ++i) {
    const Field& field = writes[i].object->type->field(writes[i].field);
    if (field.holds_refs())
      if (Status status = database.check(*writes[i].object, writes[i].field, writes[i].value); !status) {
        while (i-- > 0) database.assign(*writes[i].object, writes[i].field, std::move(writes[i].value));
        return error_at(values[0].column, status.error().kind, status.error().sentence);
      }
    Value old = writes[i].object->value(writes[i].field);
    database.assign(*writes[i].object, writes[i].field, std::move(writes[i].value));
    writes[i].value = std::move(old);
  }
  return {};
}

void look_ahead(const Database& database, std::string_view text) {
  constexpr std::size_t small_world = 1000;
  if (database.size() < small_world) return;
  struct Ahead {
    const Object* object = nullptr;
    std::string_view field;
  };
  std::array<Ahead, lines_looked_ahead> ahead;
  // look-ups that do not depend on each other wait for memory at the same time
  for (Ahead& each : ahead) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) break;
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (line.starts_with('@')) line.remove_prefix(std::min(line.find(' '), line.size() - 1) + 1);
    if (!line.starts_with("set ")) continue;
    line.remove_prefix(4);
    const std::string_view target = line.substr(0, line.find(' '));
    const std::size_t dot = target.find('.');
    if (dot == std::string_view::npos) continue;
    each = {database.find(target.substr(0, dot)), target.substr(dot + 1)};
  }
  for (const Ahead& each : ahead) {
    if (each.object == nullptr) continue;
    __builtin_prefetch(&each.object->hash_stale);
    if (const int field = each.object->type->find(each.field); field >= 0)
      __builtin_prefetch(&each.object->slots[static_cast<std::size_t>(field)]);
  }
}

Status delete_statement(Database& database, Words words, const Scope& scope) {
  const bool force = words.size() == 2 && !words[1].quoted && words[1].text == "force";
  if (words.empty() || words.size() > (force ? 2u : 1u))
    return Error{ErrorKind::syntax, "expected delete PATTERN [force]", words.empty() ? 0 : words.back().column};
  const Result<Target> target = parse_target(words[0]);
  if (!target) return target.error();
  if (!target->field.empty())
    return error_at(target->field_column, ErrorKind::syntax,
                    "a field cannot be deleted, expected the path of an object");
  const Result<std::vector<const Object*>> objects = find_objects(database, target->pattern, words[0].column, scope);
  if (!objects) return objects.error();
  std::vector<ObjectId> ids;
  for (const Object* object : *objects) ids.push_back(object->id);
  if (Status status = database.erase(ids, force); !status)
    return error_at(words[0].column, status.error().kind, status.error().sentence);
  return {};
}

void append_create(std::string& out, const Database& database, const Object& object, const Include& include) {
  const std::size_t line = out.size();
  std::vector<int> overflow;
  out += "create " + object.type->name() + " " + object.path;
  for (int i = 0; i < static_cast<int>(object.slots.size()); ++i) {
    const Field& field = object.type->field(i);
    if (field.derived || field.said_later() || !include(object, field) || object.is_default(i)) continue;
    const std::size_t before = out.size();
    out += " " + field.name + " ";
    append_value(out, field, object.value(i), database);
    if (out.size() - line <= longest_set) continue;
    out.resize(before);
    overflow.push_back(i);
  }
  out += '\n';
  for (const int field : overflow) append_set(out, database, object, field);
}

void append_later_sets(std::string& out, const Database& database, const Object& object, const Include& include) {
  for (int i = 0; i < static_cast<int>(object.slots.size()); ++i) {
    const Field& field = object.type->field(i);
    if (!field.derived && field.said_later() && include(object, field) && !object.is_default(i))
      append_set(out, database, object, i);
  }
}

void append_objects(std::string& out, const Database& database, std::span<const Object* const> objects,
                    const Include& include) {
  const Field& parent = database.schema().find("node")->field(scene::Scene::parent);
  std::vector<ObjectId> moved;
  for (const Object* object : objects) {
    append_create(out, database, *object, include);
    if (object->place && include(*object, parent) && !object->is_default(scene::Scene::parent))
      moved.push_back(object->id);
  }
  const auto but_parent = [&](const Object& object, const Field& field) {
    return &field != &parent && include(object, field);
  };
  for (const Object* object : objects) append_later_sets(out, database, *object, but_parent);
  for (const ObjectId node : database.scene().top_down(moved))
    append_set(out, database, *database.object(node), scene::Scene::parent);
}

void append_set(std::string& out, const Database& database, const Object& object, int field) {
  const Field& declared = object.type->field(field);
  if (declared.derived)
    append_set(out, database, object.path, declared, database.value(object, field));
  else
    append_set(out, database, object.path, declared, object.value(field));
}

void append_set(std::string& out, const Names& names, std::string_view path, const Field& declared,
                const Value& value) {
  if (!declared.array) {
    out.append("set ").append(path).append(".").append(declared.name).append(" ");
    append_value(out, declared, value, names);
    out += '\n';
    return;
  }
  const std::string head = "set " + std::string(path) + "." + declared.name;
  const std::size_t count = element_count(declared, value);
  std::string words, element;
  std::size_t first = 0;
  const auto flush = [&](std::size_t end) {
    // the first run says the whole value, so that what was there before is gone; the others go on from its end
    out += head;
    if (first > 0 || (end < count && declared.count != Field::any_length))
      out += "[" + std::to_string(first) + ".." + std::to_string(end - 1) + "]";
    out += words + '\n';
    words.clear();
    first = end;
  };
  for (std::size_t i = 0; i < count; ++i) {
    element = ' ';
    append_element(element, declared, value, i, names);
    if (!words.empty() && words.size() + element.size() > longest_set) flush(i);
    words += element;
  }
  if (count == 0) words = " -";
  flush(count);
}

std::string save(const Database& database) {
  std::string out;
  append_declarations(out, database.schema());
  std::vector<const Object*> objects;
  database.for_each("**", [&](const Object& object) { objects.push_back(&object); });
  append_objects(out, database, objects, [](const Object&, const Field& field) { return !field.measured; });
  return out;
}

}  // namespace objdb
