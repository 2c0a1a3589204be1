#include "objdb/unit.h"

#include <algorithm>
#include <charconv>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numbers>

#include "objdb/text.h"

namespace objdb {
namespace {

constexpr double pi = std::numbers::pi;

struct NamedUnit {
  std::string_view name;
  double multiply, divide;
  std::array<std::int8_t, 7> exponents;  // m kg s A K cd rad
};

// the first SI entry (1, 1) of a dimension is its usual name
constexpr NamedUnit named_units[] = {
    {"m", 1, 1, {1}},
    {"kg", 1, 1, {0, 1}},
    {"t", 1000, 1, {0, 1}},
    {"s", 1, 1, {0, 0, 1}},
    {"min", 60, 1, {0, 0, 1}},
    {"h", 3600, 1, {0, 0, 1}},
    {"A", 1, 1, {0, 0, 0, 1}},
    {"K", 1, 1, {0, 0, 0, 0, 1}},
    {"cd", 1, 1, {0, 0, 0, 0, 0, 1}},
    {"rad", 1, 1, {0, 0, 0, 0, 0, 0, 1}},
    {"deg", pi, 180, {0, 0, 0, 0, 0, 0, 1}},
    {"arcmin", pi, 10800, {0, 0, 0, 0, 0, 0, 1}},
    {"rev", 2 * pi, 1, {0, 0, 0, 0, 0, 0, 1}},
    {"Hz", 1, 1, {0, 0, -1}},
    {"N", 1, 1, {1, 1, -2}},
    {"Pa", 1, 1, {-1, 1, -2}},
    {"J", 1, 1, {2, 1, -2}},
    {"Nm", 1, 1, {2, 1, -2}},
    {"W", 1, 1, {2, 1, -3}},
    {"V", 1, 1, {2, 1, -3, -1}},
    {"%", 1, 100, {}},
};

// what may stand before a prefix; the gram, though no SI unit, carries those of mass
constexpr NamedUnit gram = {"g", 1, 1000, {0, 1}};
constexpr std::string_view prefixed[] = {"m", "g", "s", "A", "K", "rad", "Hz", "N", "Pa", "J", "Nm", "W", "V"};

struct Prefix {
  char letter;
  double multiply, divide;
};

constexpr Prefix prefixes[] = {{'n', 1, 1e9}, {'u', 1, 1e6}, {'m', 1, 1e3}, {'c', 1, 100}, {'d', 1, 10},
                               {'h', 100, 1}, {'k', 1e3, 1}, {'M', 1e6, 1}, {'G', 1e9, 1}};

std::optional<NamedUnit> find_unit(std::string_view name) {
  if (name == gram.name) return gram;
  for (const NamedUnit& unit : named_units)
    if (unit.name == name) return unit;
  if (name.size() < 2 || std::find(std::begin(prefixed), std::end(prefixed), name.substr(1)) == std::end(prefixed))
    return std::nullopt;
  std::optional<NamedUnit> unit = find_unit(name.substr(1));
  for (const Prefix& prefix : prefixes) {
    if (prefix.letter != name[0]) continue;
    unit->multiply *= prefix.multiply;
    unit->divide *= prefix.divide;
    return unit;
  }
  return std::nullopt;
}

// one factor: a name and an optional exponent, as in s, s^2, s2, s^-1
bool multiply_factor(Unit& unit, std::string_view text, int sign) {
  std::size_t name_end = text.size();
  int exponent = 1;
  const std::size_t digits = text.find_first_of("^-0123456789");
  if (digits != std::string_view::npos) {
    name_end = digits;
    const std::string_view power = text.substr(text[digits] == '^' ? digits + 1 : digits);
    const auto [end, error] = std::from_chars(power.data(), power.data() + power.size(), exponent);
    if (error != std::errc() || end != power.data() + power.size() || exponent == 0 || std::abs(exponent) > 9)
      return false;
  }
  const std::optional<NamedUnit> named = find_unit(text.substr(0, name_end));
  if (!named) return false;
  exponent *= sign;
  for (std::size_t i = 0; i < named->exponents.size(); ++i) {
    const int sum = unit.dimension.exponents[i] + named->exponents[i] * exponent;
    if (std::abs(sum) > 9) return false;
    unit.dimension.exponents[i] = static_cast<std::int8_t>(sum);
  }
  for (int i = 0; i < std::abs(exponent); ++i) {
    unit.multiply *= exponent > 0 ? named->multiply : named->divide;
    unit.divide *= exponent > 0 ? named->divide : named->multiply;
  }
  return true;
}

bool starts_unit(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%'; }

Error no_number(std::string_view text) { return {ErrorKind::type, shown(text) + " is not a number", 0}; }

}  // namespace

std::optional<Unit> parse_unit(std::string_view text) {
  Unit unit;
  if (text.empty()) return unit;
  int sign = 1;
  while (true) {
    const std::size_t end = text.find_first_of("/*");
    if (!multiply_factor(unit, text.substr(0, end), sign)) return std::nullopt;
    if (!std::isfinite(unit.multiply) || !std::isfinite(unit.divide)) return std::nullopt;
    if (end == std::string_view::npos) return unit;
    sign = text[end] == '/' ? -1 : 1;
    text.remove_prefix(end + 1);
  }
}

std::string si_name(const Dimension& dimension) {
  for (const NamedUnit& unit : named_units)
    if (unit.multiply == 1 && unit.divide == 1 && unit.exponents == dimension.exponents) return std::string(unit.name);

  static constexpr std::string_view base[] = {"m", "kg", "s", "A", "K", "cd", "rad"};
  std::string above, below;
  for (std::size_t i = 0; i < dimension.exponents.size(); ++i) {
    const int exponent = dimension.exponents[i];
    if (exponent == 0) continue;
    const std::string power = std::abs(exponent) == 1 ? "" : "^" + std::to_string(std::abs(exponent));
    if (exponent > 0)
      above += (above.empty() ? "" : "*") + std::string(base[i]) + power;
    else
      below += "/" + std::string(base[i]) + power;
  }
  if (!above.empty()) return above + below;
  // only divisors: s^-2 rather than 1/s^2, which would not read back
  std::string out;
  for (std::size_t i = 0; i < dimension.exponents.size(); ++i)
    if (dimension.exponents[i] != 0)
      out += (out.empty() ? "" : "*") + std::string(base[i]) + "^" + std::to_string(dimension.exponents[i]);
  return out;
}

Result<double> parse_real(std::string_view text, const Dimension& dimension) {
  const char* first = text.data();
  const char* last = first + text.size();
  if (first != last && *first == '+' && text.size() > 1 && text[1] != '-') ++first;

  // from_chars also takes nan and infinity; the database never does
  const char* digit = first != last && *first == '-' ? first + 1 : first;
  if (digit == last || !((*digit >= '0' && *digit <= '9') || *digit == '.')) return no_number(text);
  double value = 0;
  auto [end, error] = std::from_chars(first, last, value);
  if (error == std::errc::invalid_argument) return no_number(text);
  if (error == std::errc::result_out_of_range) {
    // too large or too small? whatever the locale of the program says about the decimal point
    static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
    value = strtod_l(std::string(first, end).c_str(), nullptr, plain);
    if (!std::isfinite(value))
      return Error{ErrorKind::range, shown(text) + " is beyond the largest number, 1.8e308", 0};
  }
  if (end == last) return value;

  const std::string_view suffix(end, static_cast<std::size_t>(last - end));
  // no unit begins like an exponent or a hexadecimal number
  if (!starts_unit(suffix[0]) || std::string_view("xXeE").find(suffix[0]) != std::string_view::npos)
    return no_number(text);
  const std::optional<Unit> unit = parse_unit(suffix);
  if (!unit) return Error{ErrorKind::unit, "unknown unit " + shown(suffix), 0};
  if (!(unit->dimension == dimension)) {
    const std::string expected = si_name(dimension);
    return Error{ErrorKind::unit,
                 shown(text) + " does not fit, expected " + (expected.empty() ? "a number without unit" : expected), 0};
  }
  value = unit->to_si(value);
  if (!std::isfinite(value)) return Error{ErrorKind::range, shown(text) + " is beyond the largest number, 1.8e308", 0};
  return value;
}

Result<std::int64_t> parse_integer(std::string_view text) {
  const char* first = text.data();
  const char* last = first + text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++first;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error == std::errc::result_out_of_range)
    return Error{ErrorKind::range, shown(text) + " does not fit a 64-bit integer", 0};
  if (error == std::errc() && end != last && parse_unit({end, last}))
    return Error{ErrorKind::unit, shown(text) + " does not fit, expected an integer without unit", 0};
  if (error != std::errc() || end != last) return Error{ErrorKind::type, shown(text) + " is not an integer", 0};
  return value;
}

}  // namespace objdb
