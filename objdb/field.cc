#include "objdb/field.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "objdb/type.h"

namespace objdb {
namespace {

Error at(const Word& word, Error error) {
  error.column = word.column;
  return error;
}

std::string range_text(const Field& field) { return "[" + number(field.low) + ", " + number(field.high) + "]"; }

Result<double> parse_number(const Field& field, const Word& word, int element) {
  if (word.quoted) return at(word, {ErrorKind::type, shown(word.text) + " is not a number", 0});
  Result<double> value = parse_real(word.text, field.dimension(element));
  if (!value) {
    Error error = value.error();
    error.sentence = field.name + ": " + error.sentence;
    return at(word, std::move(error));
  }
  if (field.ranged && !(*value >= field.low && *value <= field.high))
    return at(word, {ErrorKind::range,
                     field.name + " is " + shown(word.text) + ", expected a value in " + range_text(field), 0});
  return value;
}

Result<std::int64_t> parse_boolean(const Field& field, const Word& word) {
  static constexpr std::string_view yes[] = {"true", "yes", "on", "1"}, no[] = {"false", "no", "off", "0"};
  if (std::find(std::begin(yes), std::end(yes), word.text) != std::end(yes)) return std::int64_t{1};
  if (std::find(std::begin(no), std::end(no), word.text) != std::end(no)) return std::int64_t{0};
  return at(word,
            {ErrorKind::type, field.name + ": " + shown(word.text) + " is not a bool, expected true or false", 0});
}

Result<std::int64_t> parse_word(const Field& field, const Word& word) {
  for (std::size_t i = 0; i < field.words.size(); ++i)
    if (field.words[i] == word.text) return static_cast<std::int64_t>(i);
  std::string known;
  for (const std::string& name : field.words) known += (known.empty() ? "" : " ") + name;
  const std::vector<std::string_view> candidates(field.words.begin(), field.words.end());
  return at(word, {ErrorKind::type,
                   field.name + ": " + shown(word.text) + " is none of its words (" + known + ")" +
                       did_you_mean(word.text, candidates),
                   0});
}

Result<std::int64_t> parse_one_integer(const Field& field, const Word& word) {
  Result<std::int64_t> value = parse_integer(word.quoted ? std::string_view() : word.text);
  if (!value) {
    Error error = value.error();
    error.sentence = field.name + ": " + (word.quoted ? shown(word.text) + " is not an integer" : error.sentence);
    return at(word, std::move(error));
  }
  if (field.ranged &&
      !(*value >= static_cast<std::int64_t>(field.low) && *value <= static_cast<std::int64_t>(field.high)))
    return at(word, {ErrorKind::range,
                     field.name + " is " + shown(word.text) + ", expected a value in " + range_text(field), 0});
  return value;
}

Result<std::int64_t> parse_discrete(const Field& field, const Word& word, const Names& names) {
  switch (field.kind) {
    case Kind::boolean: return parse_boolean(field, word);
    case Kind::integer: return parse_one_integer(field, word);
    case Kind::word: return parse_word(field, word);
    default: break;
  }
  // no object is written "-" or ""
  if (word.text == "-" || word.text.empty()) return std::int64_t{0};
  Result<ObjectId> id = names.object(word, field.ref_type);
  if (!id) return at(word, id.error());
  return static_cast<std::int64_t>(*id);
}

Status check_word_count(const Field& field, Words words) {
  const int expected = word_count(field);
  const int given = static_cast<int>(words.size());
  const int column = words.empty() ? 0 : words.back().column;
  if (expected >= 0 && given != expected) {
    const int surplus = given > expected ? words[static_cast<std::size_t>(expected)].column : column;
    return Error{ErrorKind::syntax,
                 field.name + " takes " + std::to_string(expected) + (expected == 1 ? " word" : " words") + " (" +
                     field.kind_text() + "), got " + std::to_string(given),
                 surplus};
  }
  const int each = words_of(field.kind);
  if (expected < 0 && given % each != 0)
    return Error{ErrorKind::syntax,
                 field.name + " takes a multiple of " + std::to_string(each) + " words (" + field.kind_text() +
                     "), got " + std::to_string(given),
                 column};
  return {};
}

// index of the first of four numbers that are all 0, or the size
std::size_t null_rotation(std::span<const double> numbers) {
  for (std::size_t i = 0; i + 3 < numbers.size(); i += 4)
    if (numbers[i] == 0 && numbers[i + 1] == 0 && numbers[i + 2] == 0 && numbers[i + 3] == 0) return i;
  return numbers.size();
}

// a decimal without exponent of up to 15 digits: both the digits and the power of ten are exact doubles, so that their
// quotient is rounded once, and is the nearest double (Clinger, How to read floating point numbers accurately, 1990)
bool short_decimal(std::string_view text, double& out) {
  static constexpr double powers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14};
  const bool negative = !text.empty() && text[0] == '-';
  if (negative) text.remove_prefix(1);
  if (text.size() > 16 || text.empty() || text[0] == '.') return false;
  std::int64_t digits = 0;
  std::size_t point = text.size();
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto digit = static_cast<unsigned>(text[i] - '0');
    if (digit <= 9)
      digits = 10 * digits + digit;
    else if (text[i] == '.' && point == text.size() && i + 1 < text.size())
      point = i;
    else
      return false;
  }
  if (point == text.size() && text.size() > 15) return false;
  const auto value = static_cast<double>(digits) / powers[point == text.size() ? 0 : text.size() - point - 1];
  out = negative ? -value : value;
  return true;
}

// the usual case: a bare number that from_chars takes whole, finite and in range; all else goes the long way
bool plain_number(const Field& field, const Word& word, double& out) {
  const char *first = word.text.data(), *last = first + word.text.size();
  if (word.quoted || first == last) return false;
  if (short_decimal(word.text, out)) return !field.ranged || (out >= field.low && out <= field.high);
  const char digit = *first == '-' && last - first > 1 ? first[1] : *first;
  if (digit < '0' || digit > '9') return false;
  const auto [end, error] = std::from_chars(first, last, out);
  return error == std::errc() && end == last && (!field.ranged || (out >= field.low && out <= field.high));
}

template <std::size_t N>
Status parse_numbers(const Field& field, Words words, Value& out) {
  std::array<double, N> numbers;
  for (std::size_t i = 0; i < N; ++i) {
    if (plain_number(field, words[i], numbers[i])) continue;
    const Result<double> value = parse_number(field, words[i], 0);
    if (!value) return value.error();
    numbers[i] = *value;
  }
  // a quaternion of length 0 turns nothing into nothing
  if constexpr (N == 4)
    if (numbers == std::array<double, N>{})
      return Error{ErrorKind::range, field.name + " is 0 0 0 0, expected a rotation (w x y z)", words[0].column};
  out = numbers;
  return {};
}

Status parse_scalar(const Field& field, Words words, const Names& names, Value& out) {
  switch (field.kind) {
    case Kind::real: {
      double number = 0;
      if (!plain_number(field, words[0], number)) {
        const Result<double> value = parse_number(field, words[0], 0);
        if (!value) return value.error();
        number = *value;
      }
      out = number;
      return {};
    }
    case Kind::vec3: return parse_numbers<3>(field, words, out);
    case Kind::quat: return parse_numbers<4>(field, words, out);
    case Kind::text:
      if (std::string* text = std::get_if<std::string>(&out))
        text->assign(words[0].text);
      else
        out = std::string(words[0].text);
      return {};
    default: break;
  }
  const Result<std::int64_t> value = parse_discrete(field, words[0], names);
  if (!value) return value.error();
  out = *value;
  return {};
}

Status parse_array(const Field& field, Words words, const Names& names, Value& out) {
  switch (field.kind) {
    case Kind::real:
    case Kind::vec3:
    case Kind::quat: {
      std::vector<double> numbers;
      numbers.reserve(words.size());
      const int each = words_of(field.kind);
      for (std::size_t i = 0; i < words.size(); ++i) {
        if (double number = 0; plain_number(field, words[i], number)) {
          numbers.push_back(number);
          continue;
        }
        const Result<double> value = parse_number(field, words[i], static_cast<int>(i) / each);
        if (!value) return value.error();
        numbers.push_back(*value);
      }
      if (const std::size_t null = field.kind == Kind::quat ? null_rotation(numbers) : numbers.size();
          null < numbers.size())
        return Error{ErrorKind::range, field.name + " has 0 0 0 0, expected a rotation (w x y z)", words[null].column};
      out = std::move(numbers);
      return {};
    }
    case Kind::text: {
      std::vector<std::string> texts;
      for (const Word& word : words) texts.emplace_back(word.text);
      out = std::move(texts);
      return {};
    }
    default: break;
  }
  std::vector<std::int64_t> values;
  values.reserve(words.size());
  for (const Word& word : words) {
    const Result<std::int64_t> value = parse_discrete(field, word, names);
    if (!value) return value.error();
    values.push_back(*value);
  }
  out = std::move(values);
  return {};
}

// which alternative of Value a field uses
std::size_t alternative(const Field& field) {
  switch (field.kind) {
    case Kind::real: return field.array ? 6 : 1;
    case Kind::vec3: return field.array ? 6 : 2;
    case Kind::quat: return field.array ? 6 : 3;
    case Kind::text: return field.array ? 7 : 4;
    default: return field.array ? 5 : 0;
  }
}

Status check_text(const Field& field, std::string_view text) {
  if (is_text(text)) return {};
  return Error{ErrorKind::syntax, field.name + " holds control bytes or invalid UTF-8, expected text", 0};
}

// bool, int, word and ref
Status check_discrete(const Field& field, std::int64_t value) {
  std::int64_t low = 0, high = 0;
  switch (field.kind) {
    case Kind::boolean: high = 1; break;
    case Kind::word: high = static_cast<std::int64_t>(field.words.size()) - 1; break;
    case Kind::ref: high = std::numeric_limits<ObjectId>::max(); break;
    default:
      if (!field.ranged) return {};
      low = static_cast<std::int64_t>(field.low);
      high = static_cast<std::int64_t>(field.high);
  }
  if (value >= low && value <= high) return {};
  return Error{ErrorKind::range,
               field.name + " is " + std::to_string(value) + ", expected a value in [" + std::to_string(low) + ", " +
                   std::to_string(high) + "]",
               0};
}

void append_discrete(std::string& out, const Field& field, std::int64_t value, const Names& names) {
  switch (field.kind) {
    case Kind::boolean: out += value != 0 ? "true" : "false"; break;
    case Kind::word:
      append_quoted(out, field.words.empty() ? std::string_view()
                                             : std::string_view(field.words[static_cast<std::size_t>(value)]));
      break;
    case Kind::ref:
      // alone, "-" in an array of any length would read as the empty array
      if (value == 0)
        out += field.array ? "\"\"" : "-";
      else
        out += names.path(static_cast<ObjectId>(value));
      break;
    default: append_number(out, value);
  }
}

}  // namespace

const Dimension& Field::dimension(int element) const {
  static const Dimension none;
  if (dimensions.empty()) return none;
  return dimensions.size() == 1 ? dimensions[0] : dimensions[static_cast<std::size_t>(element)];
}

std::string Field::unit() const {
  std::string out;
  for (const Dimension& each : dimensions) out += (out.empty() ? "" : ",") + si_name(each);
  return out;
}

std::string Field::kind_text() const {
  std::string out(objdb::name_of(kind));
  if (ref_type != nullptr) out += ":" + ref_type->name();
  if (array) out += count == any_length ? "[]" : "[" + std::to_string(count) + "]";
  return out;
}

std::string Field::declaration() const {
  // the default of a ref is always "no object", so no names are needed
  struct NoNames : Names {
    Result<ObjectId> object(const Word&, const Type*) const override { return ObjectId{0}; }
    std::string_view path(ObjectId) const override { return "-"; }
  };
  std::string out = "field " + owner->name() + "." + name + " " + kind_text();
  if (const std::string text = unit(); !text.empty()) out += " " + text;
  if (!same_bits(standard, zero_value(*this))) {
    out += " = ";
    append_value(out, *this, standard, NoNames());
  }
  if (ranged) out += " in " + number(low) + " " + number(high);
  if (kind == Kind::word) {
    out += " of";
    for (const std::string& word : words) out += " " + word;
  }
  if (is_private) out += " private";
  if (measured) out += " measured";
  if (!doc.empty()) {
    // quoted even when one word, so that it is never taken for a keyword
    const std::string text = quote(doc);
    out += text[0] == '"' ? " " + text : " \"" + text + "\"";
  }
  return out;
}

int word_count(const Field& field) {
  if (field.count == Field::any_length) return -1;
  return field.count * words_of(field.kind);
}

Status parse_value_into(const Field& field, Words words, const Names& names, Value& out) {
  if (field.count == Field::any_length && words.size() == 1 && words[0].text == "-" && !words[0].quoted) words = {};
  if (Status count = check_word_count(field, words); !count) return count;
  return field.array ? parse_array(field, words, names, out) : parse_scalar(field, words, names, out);
}

Result<Value> parse_value(const Field& field, Words words, const Names& names) {
  Value value;
  if (Status parsed = parse_value_into(field, words, names, value); !parsed) return parsed.error();
  return value;
}

std::size_t element_count(const Field& field, const Value& value) {
  if (!field.array) return 1;
  if (const auto* numbers = std::get_if<Numbers>(&value))
    return numbers->size() / static_cast<std::size_t>(words_of(field.kind));
  if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&value)) return integers->size();
  return std::get<std::vector<std::string>>(value).size();
}

void append_element(std::string& out, const Field& field, const Value& value, std::size_t index, const Names& names) {
  if (const auto* numbers = std::get_if<Numbers>(&value)) {
    const auto each = static_cast<std::size_t>(words_of(field.kind));
    for (std::size_t i = 0; i < each; ++i) {
      if (i != 0) out += ' ';
      append_number(out, (*numbers)[index * each + i]);
    }
  } else if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&value)) {
    append_discrete(out, field, (*integers)[index], names);
  } else if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    append_quoted(out, (*texts)[index]);
  } else {
    append_value(out, field, value, names);
  }
}

void append_value(std::string& out, const Field& field, const Value& value, const Names& names) {
  if (field.array) {
    const std::size_t count = element_count(field, value);
    if (count == 0) out += '-';
    for (std::size_t i = 0; i < count; ++i) {
      if (i != 0) out += ' ';
      append_element(out, field, value, i, names);
    }
    return;
  }
  if (const double* real = std::get_if<double>(&value)) {
    append_number(out, *real);
  } else if (const Vec3* vec = std::get_if<Vec3>(&value)) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (i != 0) out += ' ';
      append_number(out, (*vec)[i]);
    }
  } else if (const Quat* quat = std::get_if<Quat>(&value)) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (i != 0) out += ' ';
      append_number(out, (*quat)[i]);
    }
  } else if (const std::string* text = std::get_if<std::string>(&value)) {
    append_quoted(out, *text);
  } else {
    append_discrete(out, field, std::get<std::int64_t>(value), names);
  }
}

Value zero_value(const Field& field) {
  const auto size = static_cast<std::size_t>(field.count == Field::any_length ? 0 : field.count);
  switch (field.kind) {
    case Kind::real: return field.array ? Value(std::vector<double>(size)) : Value(0.0);
    case Kind::vec3: return field.array ? Value(std::vector<double>(3 * size)) : Value(Vec3{});
    case Kind::quat: {
      if (!field.array) return Quat{1, 0, 0, 0};
      std::vector<double> numbers(4 * size);
      for (std::size_t i = 0; i < size; ++i) numbers[4 * i] = 1;
      return numbers;
    }
    case Kind::text: return field.array ? Value(std::vector<std::string>(size)) : Value(std::string());
    default: return field.array ? Value(std::vector<std::int64_t>(size)) : Value(std::int64_t{0});
  }
}

Status check_value(const Field& field, const Value& value) {
  if (value.index() != alternative(field))
    return Error{ErrorKind::type, field.name + ": a value of another kind, expected " + field.kind_text(), 0};
  if (field.array && field.count != Field::any_length &&
      element_count(field, value) != static_cast<std::size_t>(field.count))
    return Error{
        ErrorKind::type,
        field.name + " has " + std::to_string(element_count(field, value)) + " elements, expected " + field.kind_text(),
        0};
  const auto check = [&](double x) -> Status {
    if (!std::isfinite(x)) return Error{ErrorKind::type, field.name + ": " + number(x) + " is not a finite number", 0};
    if (field.ranged && !(x >= field.low && x <= field.high))
      return Error{ErrorKind::range, field.name + " is " + number(x) + ", expected a value in " + range_text(field), 0};
    return {};
  };
  const auto check_all = [&](const auto& numbers) -> Status {
    // one quick look at all of them: only what is wrong needs a sentence
    constexpr double most = std::numeric_limits<double>::max();
    const double low = field.ranged ? field.low : -most, high = field.ranged ? field.high : most;
    bool good = true;
    if constexpr (std::is_same_v<std::decay_t<decltype(numbers)>, Numbers>)
      if (!field.ranged && all_finite(numbers)) return {};
    for (const double x : numbers) good = good & (x >= low) & (x <= high);
    if (good) return {};
    for (const auto x : numbers)
      if (Status status = check(static_cast<double>(x)); !status) return status;
    return {};
  };
  if (const double* real = std::get_if<double>(&value)) return check(*real);
  if (const Vec3* vec = std::get_if<Vec3>(&value)) return check_all(*vec);
  if (const Quat* quat = std::get_if<Quat>(&value)) {
    if (*quat == Quat{}) return Error{ErrorKind::range, field.name + " is 0 0 0 0, expected a rotation (w x y z)", 0};
    return check_all(*quat);
  }
  if (const auto* numbers = std::get_if<Numbers>(&value)) {
    if (field.kind == Kind::quat && null_rotation(*numbers) < numbers->size())
      return Error{ErrorKind::range, field.name + " has 0 0 0 0, expected a rotation (w x y z)", 0};
    return check_all(*numbers);
  }
  if (const auto* text = std::get_if<std::string>(&value)) return check_text(field, *text);
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    for (const std::string& text : *texts)
      if (Status status = check_text(field, text); !status) return status;
    return {};
  }
  if (const auto* one = std::get_if<std::int64_t>(&value)) return check_discrete(field, *one);
  for (const std::int64_t each : std::get<std::vector<std::int64_t>>(value))
    if (Status status = check_discrete(field, each); !status) return status;
  return {};
}

}  // namespace objdb
