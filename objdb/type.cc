#include "objdb/type.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace objdb {
namespace {

Error error_at(const Word& word, ErrorKind kind, std::string sentence) {
  return {kind, std::move(sentence), word.column};
}

Error name_too_long(const Word& word) {
  return error_at(
      word, ErrorKind::limit,
      shown(word.text) + " is too long, expected a name of at most " + std::to_string(longest_name) + " bytes");
}

Error declaration_too_long(const Word& word) {
  return error_at(
      word, ErrorKind::limit,
      shown(word.text) + ": the line that declares it would be longer than " + std::to_string(longest_line) + " bytes");
}

// the first three and the last four bytes of a name, and its length
std::uint64_t name_key(std::string_view name) {
  std::uint64_t key = name.size();
  const auto take = [&](std::size_t i) { key = key << 8 | static_cast<unsigned char>(name[i]); };
  for (std::size_t i = 0; i < std::min<std::size_t>(name.size(), 3); ++i) take(i);
  for (std::size_t i = name.size() - std::min<std::size_t>(name.size(), 4); i < name.size(); ++i) take(i);
  return key;
}

// reads the words of a `field` line one after the other
class FieldParser {
 public:
  FieldParser(const Schema& schema, Words words) : schema_(schema), words_(words) {}

  Result<Field> parse() {
    if (words_.size() < 2)
      return Error{ErrorKind::syntax, "expected field TYPE.NAME KIND", words_.empty() ? 0 : words_[0].column};
    if (Status status = name(); !status) return status.error();
    if (Status status = kind(); !status) return status.error();
    while (at_ < words_.size()) {
      const Word word = words_[at_++];
      Status status;
      if (word.quoted) {
        status = doc(word);
      } else if (word.text == "=") {
        status = standard(word);
      } else if (word.text == "in") {
        status = range(word);
      } else if (word.text == "of") {
        status = word_list(word);
      } else if (word.text == "private") {
        field_.is_private = true;
      } else if (word.text == "measured") {
        field_.measured = true;
      } else if (word.text == "derived") {
        field_.derived = true;
      } else {
        status = unit(word);
      }
      if (!status) return status.error();
    }
    return finish();
  }

 private:
  Status name() {
    const Word word = words_[at_++];
    const std::size_t dot = word.text.find('.');
    if (dot == std::string_view::npos)
      return error_at(word, ErrorKind::syntax, shown(word.text) + " has no '.', expected TYPE.NAME");
    const Result<const Type*> type = schema_.type({word.text.substr(0, dot), word.column, false});
    if (!type) return type.error();
    field_.owner = *type;
    field_.name = word.text.substr(dot + 1);
    if (field_.name.size() > longest_name) return name_too_long(word);
    if (!is_name(field_.name))
      return error_at(word, ErrorKind::syntax, shown(field_.name) + " is not a name ([A-Za-z_][A-Za-z0-9_]*)");
    return {};
  }

  Status kind() {
    const Word word = words_[at_++];
    std::string_view text = word.text;
    const std::size_t bracket = text.find('[');
    if (bracket != std::string_view::npos) {
      field_.array = true;
      field_.count = Field::any_length;
      const std::string_view inside = text.substr(bracket + 1);
      if (inside != "]") {
        const Result<std::int64_t> count = inside.empty() || inside.back() != ']'
                                               ? Result<std::int64_t>(Error{ErrorKind::syntax, "", 0})
                                               : parse_integer(inside.substr(0, inside.size() - 1));
        if (!count || *count < 1 || *count > 1'000'000)
          return error_at(word, ErrorKind::syntax,
                          shown(text) + " is not a kind, expected KIND[] or KIND[n], 1 <= n <= 1000000");
        field_.count = static_cast<int>(*count);
      }
      text = text.substr(0, bracket);
    }
    if (text.starts_with("ref:")) {
      const Result<const Type*> type = schema_.type({text.substr(4), word.column + 4, false});
      if (!type) return type.error();
      field_.ref_type = *type;
      text = "ref";
    }
    for (const Kind kind :
         {Kind::boolean, Kind::integer, Kind::real, Kind::vec3, Kind::quat, Kind::word, Kind::text, Kind::ref}) {
      if (name_of(kind) != text) continue;
      field_.kind = kind;
      return {};
    }
    return error_at(
        word, ErrorKind::type,
        shown(word.text) + " is not a kind (bool int real vec3 quat word text ref ref:TYPE, with [] or [n])");
  }

  // one unit for all elements or, joined by ',', one an element
  Status unit(const Word& word) {
    if (!units_.empty()) return error_at(word, ErrorKind::syntax, "unexpected " + shown(word.text));
    if (!word.text.empty() && word.text.find_first_of("0123456789.-+") == 0)
      return error_at(word, ErrorKind::syntax, "unexpected " + shown(word.text));
    if (field_.kind != Kind::real && field_.kind != Kind::vec3)
      return error_at(word, ErrorKind::unit, shown(word.text) + ": a " + field_.kind_text() + " has no unit");
    std::string_view rest = word.text;
    while (true) {
      const std::size_t comma = rest.find(',');
      const std::optional<Unit> unit = parse_unit(rest.substr(0, comma));
      if (!unit) return error_at(word, ErrorKind::unit, "unknown unit " + shown(rest.substr(0, comma)));
      units_.push_back(*unit);
      if (comma == std::string_view::npos) break;
      rest.remove_prefix(comma + 1);
    }
    if (units_.size() > 1 && static_cast<int>(units_.size()) != field_.count)
      return error_at(
          word, ErrorKind::unit,
          shown(word.text) + " names " + std::to_string(units_.size()) + " units, expected one or one an element");
    for (const Unit& each : units_) field_.dimensions.push_back(each.dimension);
    return {};
  }

  Status doc(const Word& word) {
    if (has_doc_) return error_at(word, ErrorKind::syntax, "a second doc text");
    has_doc_ = true;
    field_.doc = word.text;
    return {};
  }

  // the values stand until the next keyword; they are read when unit, words and range are known
  Status standard(const Word& equals) {
    if (!standard_.empty()) return error_at(equals, ErrorKind::syntax, "a second default");
    const int count = word_count(field_);
    const std::size_t first = at_;
    if (count >= 0) {
      at_ = std::min(words_.size(), at_ + static_cast<std::size_t>(count));
    } else {
      while (at_ < words_.size() && !is_keyword(words_[at_])) ++at_;
    }
    standard_ = words_.subspan(first, at_ - first);
    // the words of a text[] end at the first quote, which opens the doc: what must be quoted cannot be among them
    if (count < 0 && field_.kind == Kind::text)
      for (const Word& word : standard_)
        if (quote(word.text)[0] == '"' && !(word.text == "-" && standard_.size() == 1))
          return error_at(word, ErrorKind::syntax,
                          shown(word.text) + " needs quotes, which a default of text[] cannot have");
    if (standard_.empty() || (count >= 0 && static_cast<int>(standard_.size()) < count))
      return error_at(equals, ErrorKind::syntax,
                      "the default of " + field_.name + " takes " +
                          (count < 0 ? "at least 1 word" : std::to_string(count) + (count == 1 ? " word" : " words")));
    return {};
  }

  Status range(const Word& in) {
    if (at_ + 2 > words_.size()) return error_at(in, ErrorKind::syntax, "expected in LO HI");
    if (field_.kind != Kind::real && field_.kind != Kind::vec3 && field_.kind != Kind::integer)
      return error_at(in, ErrorKind::type, "a " + field_.kind_text() + " has no range");
    range_ = words_.subspan(at_, 2);
    at_ += 2;
    return {};
  }

  Status word_list(const Word& of) {
    if (field_.kind != Kind::word) return error_at(of, ErrorKind::type, "a " + field_.kind_text() + " has no words");
    while (at_ < words_.size() && !is_keyword(words_[at_])) {
      const Word word = words_[at_++];
      if (std::find(field_.words.begin(), field_.words.end(), word.text) != field_.words.end())
        return error_at(word, ErrorKind::exists, shown(word.text) + " stands twice among the words");
      if (word.text.size() > longest_name) return name_too_long(word);
      field_.words.emplace_back(word.text);
    }
    if (field_.words.empty()) return error_at(of, ErrorKind::syntax, "expected of WORD WORD ...");
    return {};
  }

  static bool is_keyword(const Word& word) {
    if (word.quoted) return true;
    static constexpr std::string_view keywords[] = {"=", "in", "of", "private", "measured", "derived"};
    return std::find(std::begin(keywords), std::end(keywords), word.text) != std::end(keywords);
  }

  // a bare number of a declaration is in the unit that the declaration names; everywhere else it is SI
  Result<double> declared_number(const Word& word, int element) {
    Result<double> value = parse_real(word.text, field_.dimension(element));
    if (!value) return error_at(word, value.error().kind, value.error().sentence);
    const bool bare = parse_real(word.text, Dimension{}).ok() && !word.text.ends_with('%');
    if (!bare || units_.empty()) return value;
    return units_.size() == 1 ? units_[0].to_si(*value) : units_[static_cast<std::size_t>(element)].to_si(*value);
  }

  Result<Field> finish() {
    if (field_.kind == Kind::word && field_.words.empty())
      return Error{ErrorKind::syntax, "a word field needs its words: of WORD WORD ...", words_[1].column};
    if (!range_.empty()) {
      const Result<double> low = declared_number(range_[0], 0), high = declared_number(range_[1], 0);
      if (!low) return low.error();
      if (!high) return high.error();
      if (!(*low <= *high)) return error_at(range_[0], ErrorKind::range, "the range is empty, expected LO <= HI");
      field_.ranged = true;
      field_.low = *low;
      field_.high = *high;
      // whole numbers that a double holds exactly
      if (field_.kind == Kind::integer) {
        constexpr double most = 9007199254740992;
        field_.low = std::max(std::ceil(*low), -most) + 0.0;
        field_.high = std::min(std::floor(*high), most) + 0.0;
        if (!(field_.low <= field_.high))
          return error_at(range_[0], ErrorKind::range, "no whole number of at most 2^53 is in the range");
      }
    }
    field_.standard = zero_value(field_);
    if (field_.kind == Kind::ref && !standard_.empty())
      return error_at(standard_[0], ErrorKind::type, "a ref has no default");
    if (!standard_.empty()) {
      if (Status status = parse_standard(); !status) return status.error();
    } else if (field_.ranged) {
      pull_into_range();
    }
    return std::move(field_);
  }

  Status parse_standard() {
    const bool converts = std::any_of(units_.begin(), units_.end(), [](const Unit& unit) { return !unit.is_si(); });
    std::vector<std::string> texts;
    std::vector<Word> converted(standard_.begin(), standard_.end());
    if (converts) {
      texts.reserve(converted.size());
      for (std::size_t i = 0; i < converted.size(); ++i) {
        const int element = units_.size() == 1 ? 0 : static_cast<int>(i) / words_of(field_.kind);
        const Result<double> value = declared_number(converted[i], element);
        if (!value) return value.error();
        converted[i].text = texts.emplace_back(number(*value));
      }
    }
    struct NoNames : Names {
      Result<ObjectId> object(const Word&, const Type*) const override { return ObjectId{0}; }
      std::string_view path(ObjectId) const override { return "-"; }
    };
    const Result<Value> value = parse_value(field_, converted, NoNames());
    if (!value) return value.error();
    field_.standard = *value;
    return {};
  }

  // without a default the default is 0, or the end of the range that is nearest to it
  void pull_into_range() {
    const double nearest = std::clamp(0.0, field_.low, field_.high);
    if (double* real = std::get_if<double>(&field_.standard)) *real = nearest;
    if (Vec3* vec = std::get_if<Vec3>(&field_.standard)) vec->fill(nearest);
    if (std::int64_t* integer = std::get_if<std::int64_t>(&field_.standard))
      *integer = static_cast<std::int64_t>(nearest);
    if (auto* numbers = std::get_if<Numbers>(&field_.standard))
      *numbers = Numbers(std::vector<double>(numbers->size(), nearest));
    if (auto* integers = std::get_if<std::vector<std::int64_t>>(&field_.standard))
      std::fill(integers->begin(), integers->end(), static_cast<std::int64_t>(nearest));
  }

  const Schema& schema_;
  Words words_;
  std::size_t at_ = 0;
  Field field_;
  std::vector<Unit> units_;
  Words standard_, range_;
  bool has_doc_ = false;
};

std::string without_doc(Field field) {
  field.doc.clear();
  return field.declaration();
}

}  // namespace

Type::Type(std::string name, const Type* base, std::string doc)
    : name_(std::move(name)), doc_(std::move(doc)), base_(base) {
  if (base_ != nullptr)
    for (const Field* field : base_->fields_) add(*field);
}

void Type::add(const Field& field) {
  fields_.push_back(&field);
  keys_.push_back(name_key(field.name));
}

bool Type::is(const Type& ancestor) const {
  for (const Type* type = this; type != nullptr; type = type->base_)
    if (type == &ancestor) return true;
  return false;
}

int Type::find(std::string_view name) const {
  const std::uint64_t key = name_key(name);
  // the key of a short name is all of it
  const bool whole = name.size() <= 7;
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (keys_[i] == key && (whole || fields_[i]->name == name)) return static_cast<int>(i);
  return -1;
}

int Type::find(const Field& field) const {
  for (std::size_t i = 0; i < fields_.size(); ++i)
    if (fields_[i] == &field) return static_cast<int>(i);
  return -1;
}

std::string Type::hint(std::string_view name) const {
  std::vector<std::string_view> names;
  for (const Field* field : fields_) names.push_back(field->name);
  return did_you_mean(name, names);
}

Schema::Schema() {
  LineWords line;
  for (std::string_view text : built_in_types()) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      [[maybe_unused]] const Status split = line.split(text.substr(0, end));
      assert(split.ok());
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      if (line.empty()) continue;
      const Words rest = line.words().subspan(1);
      [[maybe_unused]] const bool good =
          line.words()[0].text == "type" ? declare_type(rest).ok() : declare_field(rest).ok();
      assert(good);
    }
  }
  built_in_ = types_.size();
}

const Type* Schema::find(std::string_view name) const {
  const auto found = by_name_.find(std::string(name));
  return found == by_name_.end() ? nullptr : found->second;
}

bool Schema::is_built_in(const Type& type) const {
  for (std::size_t i = 0; i < built_in_; ++i)
    if (types_[i].get() == &type) return true;
  return false;
}

Type& Schema::mutable_type(const Type& type) { return *by_name_.find(type.name())->second; }

Result<const Type*> Schema::type(const Word& word) const {
  if (const Type* found = find(word.text)) return found;
  if (!is_name(word.text)) return error_at(word, ErrorKind::syntax, shown(word.text) + " is not a name of a type");
  std::vector<std::string_view> names;
  for (const auto& each : types_) names.push_back(each->name());
  return error_at(word, ErrorKind::unknown, "no type " + shown(word.text) + did_you_mean(word.text, names));
}

Result<const Field*> Schema::field(const Word& word) const {
  const std::size_t dot = word.text.find('.');
  if (dot == std::string_view::npos)
    return error_at(word, ErrorKind::syntax, shown(word.text) + " has no '.', expected TYPE.FIELD");
  const Result<const Type*> owner = type({word.text.substr(0, dot), word.column, false});
  if (!owner) return owner.error();
  const std::string_view name = word.text.substr(dot + 1);
  const int index = (*owner)->find(name);
  if (index < 0)
    return error_at(word, ErrorKind::unknown, (*owner)->name() + " has no field " + shown(name) + (*owner)->hint(name));
  return &(*owner)->field(index);
}

Result<const Type*> Schema::declare_type(Words words) {
  if (words.empty()) return Error{ErrorKind::syntax, "expected type NAME [extends BASE] [\"doc\"]", 0};
  const Word name = words[0];
  if (name.quoted || !is_name(name.text))
    return error_at(name, ErrorKind::syntax, shown(name.text) + " is not a name ([A-Za-z_][A-Za-z0-9_]*)");
  if (name.text.size() > longest_name) return name_too_long(name);
  const Type* base = nullptr;
  std::string doc;
  std::size_t at = 1;
  if (at < words.size() && !words[at].quoted && words[at].text == "extends") {
    if (at + 1 == words.size()) return error_at(words[at], ErrorKind::syntax, "expected extends BASE");
    const Result<const Type*> found = type(words[at + 1]);
    if (!found) return found.error();
    base = *found;
    at += 2;
  }
  if (at < words.size() && words[at].quoted) doc = words[at++].text;
  if (at < words.size()) return error_at(words[at], ErrorKind::syntax, "unexpected " + shown(words[at].text));

  if (const Type* known = find(name.text)) {
    if (known->base() == base) return known;
    return error_at(name, ErrorKind::exists,
                    "type " + known->name() + " is known and extends " +
                        (known->base() == nullptr ? "nothing" : known->base()->name()));
  }
  if (name.text.size() + (base == nullptr ? 0 : base->name().size()) + quote(doc).size() + 32 > longest_line)
    return declaration_too_long(name);
  Type& made = *types_.emplace_back(std::make_unique<Type>(std::string(name.text), base, std::move(doc)));
  by_name_.emplace(made.name(), &made);
  return &made;
}

Result<Schema::Declared> Schema::declare_field(Words words) {
  Result<Field> parsed = FieldParser(*this, words).parse();
  if (!parsed) return parsed.error();
  const Type& owner = *parsed->owner;
  const Word& word = words[0];
  if (parsed->derived && built_in_ != 0)
    return error_at(word, ErrorKind::syntax, "only built-in fields can be derived");
  if (const int known = owner.find(parsed->name); known >= 0) {
    const Field& field = owner.field(known);
    if (field.owner == &owner && without_doc(field) == without_doc(*parsed)) return Declared{&field, false};
    return error_at(word, ErrorKind::exists,
                    field.owner->name() + "." + field.name + " is known: " + without_doc(field));
  }
  // a subtype may have a field of that name already: then the new one has no room there
  for (const auto& type : types_)
    if (type->is(owner) && type->find(parsed->name) >= 0)
      return error_at(word, ErrorKind::exists,
                      type->name() + ", which extends " + owner.name() + ", has a field " + parsed->name);

  // numbers may take twenty times the room in SI; a short line needs no look
  std::size_t said = 0;
  for (const Word& each : words) said += each.text.size() + 1;
  if (said > longest_line / 32 && parsed->declaration().size() >= longest_line) return declaration_too_long(word);

  const Field& field = *fields_.emplace_back(std::make_unique<Field>(std::move(*parsed)));
  for (const auto& type : types_)
    if (type->is(owner)) mutable_type(*type).add(field);
  return Declared{&field, true};
}

std::uint64_t Schema::hash() const {
  std::uint64_t hash = 0;
  for (const auto& type : types_) {
    hash = hash_text(type->name(), hash);
    if (type->base() != nullptr) hash = hash_text(type->base()->name(), hash);
    for (const Field* field : type->fields())
      if (field->owner == type.get()) hash = hash_text(without_doc(*field), hash);
  }
  return hash;
}

}  // namespace objdb
