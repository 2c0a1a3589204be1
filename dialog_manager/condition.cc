#include "dialog_manager/condition.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace manager {
namespace {

using namespace objdb;

constexpr std::array<std::string_view, 6> operators = {"==", "!=", "<", "<=", ">", ">="};

// a whole number or real as one double; nothing for other kinds
std::optional<double> as_number(const Field& field, const Value& value) {
  if (field.kind == Kind::integer)
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return std::nullopt;
}

std::vector<double> components(const Value& value) {
  if (const auto* real = std::get_if<double>(&value)) return {*real};
  if (const auto* vec = std::get_if<Vec3>(&value)) return {vec->begin(), vec->end()};
  if (const auto* quat = std::get_if<Quat>(&value)) return {quat->begin(), quat->end()};
  if (const auto* many = std::get_if<Numbers>(&value)) return many->vector();
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return {static_cast<double>(*integer)};
  return {};
}

// what stands between two numbers beyond a tolerance, but for the rounding of both: 4cm is 5cm +- 1cm
bool within(double distance, double tolerance, double x, double y) {
  if (distance <= tolerance) return true;
  constexpr double unit_roundoff = 0x1p-52;
  return tolerance > 0 && distance - tolerance <= unit_roundoff * std::max(std::abs(x), std::abs(y));
}

// equality of numbers is of values (0 == -0), with a tolerance in each component
bool equal(const Field& field, const Value& a, const Value& b, double tolerance) {
  if (field.kind == Kind::integer && tolerance == 0) return same_bits(a, b);
  const bool numeric = field.kind == Kind::real || field.kind == Kind::vec3 || field.kind == Kind::quat ||
                       (field.kind == Kind::integer && !field.array);
  if (!numeric) return same_bits(a, b);
  const std::vector<double> left = components(a), right = components(b);
  return left.size() == right.size() && std::equal(left.begin(), left.end(), right.begin(), [&](double x, double y) {
           return within(std::abs(x - y), tolerance, x, y);
         });
}

// the field that one element of an array, or one component of a vec3 or quat, is
Field element_of(const Field& field) {
  Field one = field;
  if (!field.array && words_of(field.kind) > 1) one.kind = Kind::real;
  one.array = false;
  one.count = Field::scalar;
  if (one.dimensions.size() > 1) one.dimensions.clear();
  return one;
}

std::size_t part_count(const Field& field, const Value& value) {
  return field.array ? element_count(field, value) : static_cast<std::size_t>(words_of(field.kind));
}

Value element(const Field& field, const Value& value, std::size_t index) {
  if (!field.array) {
    if (words_of(field.kind) == 1) return value;
    return components(value)[index];
  }
  if (const auto* numbers = std::get_if<Numbers>(&value)) {
    const double* first = numbers->data() + index * static_cast<std::size_t>(words_of(field.kind));
    if (field.kind == Kind::vec3) return Vec3{first[0], first[1], first[2]};
    if (field.kind == Kind::quat) return Quat{first[0], first[1], first[2], first[3]};
    return first[0];
  }
  if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&value)) return (*integers)[index];
  return std::get<std::vector<std::string>>(value)[index];
}

}  // namespace

Result<Condition> Condition::parse(const Database& world, Words words, const Scope& scope, std::size_t& used) {
  const auto syntax = [&](std::size_t at, std::string sentence) {
    const int column = words.empty() ? 0 : words[std::min(at, words.size() - 1)].column;
    return Error{ErrorKind::syntax, std::move(sentence), column};
  };
  if (words.size() < 3) return syntax(words.size(), "expected a condition: FIELD OP VALUE [+- TOL]");
  Condition condition;
  condition.scope_ = scope;
  condition.target_ = words[0].text;
  condition.column_ = words[0].column;
  const auto op = std::find(operators.begin(), operators.end(), words[1].text);
  if (op == operators.end()) return syntax(1, quote(words[1].text) + " is no comparison (== != < <= > >=)");
  condition.compare_ = static_cast<Compare>(op - operators.begin());

  // the field says how many words its value takes
  const Result<Target> target = parse_target({condition.target_, words[0].column, false});
  if (!target) return target.error();
  if (target->field.empty()) return syntax(0, quote(words[0].text) + " names no field, expected PATH.FIELD");
  const Result<std::vector<const Object*>> objects = find_objects(world, target->pattern, words[0].column, scope);
  if (!objects) return objects.error();
  const Object* with_field = nullptr;
  for (const Object* object : *objects)
    if (with_field == nullptr && object->type->find(target->field) >= 0) with_field = object;
  if (with_field == nullptr) return find_field(*objects->front(), target->field, target->field_column).error();
  const Field& field = with_field->type->field(with_field->type->find(target->field));
  const bool ordered = condition.compare_ != Compare::equal && condition.compare_ != Compare::unequal;
  const Field compared = target->sliced ? element_of(field) : field;
  if (ordered && !(!compared.array && (compared.kind == Kind::real || compared.kind == Kind::integer)))
    return Error{ErrorKind::type,
                 quote(words[1].text) + " compares numbers, " + with_field->path + "." + field.name + " is a " +
                     field.kind_text(),
                 words[1].column};

  const int words_each = field.array ? words_of(field.kind) : 1;
  std::size_t count = static_cast<std::size_t>(target->sliced ? words_each : std::max(word_count(field), 0));
  if (!target->sliced && word_count(field) < 0)
    while (2 + count < words.size() && words[2 + count].text != "+-" && words[2 + count].text != "for") ++count;
  if (words.size() < 2 + count)
    return syntax(words.size(), field.name + " takes " + std::to_string(count) + " words (" + field.kind_text() + ")");
  condition.expected_ = words[1].text;
  for (std::size_t i = 0; i < count; ++i) {
    condition.values_.emplace_back(words[2 + i].text);
    condition.quoted_.push_back(words[2 + i].quoted);
    condition.expected_ += " " + quote(words[2 + i].text);
  }
  used = 2 + count;
  if (used < words.size() && words[used].text == "+-") {
    if (used + 1 == words.size()) return syntax(used, "expected a tolerance after +-");
    condition.tolerance_ = words[used + 1].text;
    condition.expected_ += " +- " + condition.tolerance_;
    used += 2;
  }
  condition.text_ = condition.target_ + " " + condition.expected_;
  // a first look finds wrong values and units now, at their columns
  std::vector<Word> value_words(words.begin() + 2, words.begin() + 2 + static_cast<std::ptrdiff_t>(count));
  const ScopedNames names(world, scope);
  Field unranged = compared;
  unranged.ranged = false;
  if (const Result<Value> value = parse_value(unranged, value_words, names); !value) return value.error();
  if (!condition.tolerance_.empty()) {
    const Result<double> tolerance = parse_real(condition.tolerance_, field.dimension(0));
    if (!tolerance) return Error{tolerance.error().kind, tolerance.error().sentence, words[used - 1].column};
    if (!(*tolerance >= 0))
      return Error{ErrorKind::range, "the tolerance is " + condition.tolerance_ + ", expected 0 or more",
                   words[used - 1].column};
  }
  return condition;
}

Result<bool> Condition::holds(const Database& world) const { return check(world, nullptr); }

std::string Condition::failure(const Database& world) const {
  std::string out;
  if (const Result<bool> held = check(world, &out); !held) return held.error().sentence;
  return out;
}

Result<bool> Condition::check(const Database& world, std::string* failure) const {
  const Result<Target> target = parse_target({target_, column_, false});
  const Result<std::vector<const Object*>> objects = find_objects(world, target->pattern, column_, scope_);
  if (!objects) return objects.error();
  const ScopedNames names(world, scope_);
  std::vector<Word> words;
  for (std::size_t i = 0; i < values_.size(); ++i) words.push_back({values_[i], column_, quoted_[i]});

  bool any = false;
  for (const Object* object : *objects) {
    const int index = object->type->find(target->field);
    if (index < 0) continue;
    any = true;
    const Field& declared = object->type->field(index);
    Value value = world.value(*object, index);
    Field field = target->sliced ? element_of(declared) : declared;
    field.ranged = false;
    if (target->sliced) {
      if (target->first >= part_count(declared, value))
        return Error{ErrorKind::range,
                     object->path + "." + declared.name + " has no element " + std::to_string(target->first), column_};
      value = element(declared, value, target->first);
    }
    const Result<Value> wanted = parse_value(field, words, names);
    if (!wanted) return wanted.error();
    double tolerance = 0;
    if (!tolerance_.empty()) {
      const Result<double> parsed = parse_real(tolerance_, field.dimension(0));
      if (!parsed) return parsed.error();
      tolerance = *parsed;
    }
    bool good = false;
    if (compare_ == Compare::equal || compare_ == Compare::unequal) {
      good = equal(field, value, *wanted, tolerance) == (compare_ == Compare::equal);
    } else {
      const double left = *as_number(field, value), right = *as_number(field, *wanted);
      good = compare_ == Compare::less         ? left < right + tolerance
             : compare_ == Compare::less_equal ? left <= right || within(left - right, tolerance, left, right)
             : compare_ == Compare::greater    ? left > right - tolerance
                                               : left >= right || within(right - left, tolerance, left, right);
    }
    if (good) continue;
    if (failure != nullptr) {
      *failure = object->path + "." + std::string(target->field);
      if (target->sliced) *failure += "[" + std::to_string(target->first) + "]";
      *failure += " is ";
      append_value(*failure, field, value, world);
      *failure += ", expected " + expected_;
    }
    return false;
  }
  if (!any)
    return Error{ErrorKind::unknown,
                 "no object that fits " + std::string(target->pattern) + " has a field " + std::string(target->field),
                 column_};
  return true;
}

}  // namespace manager
