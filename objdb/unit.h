#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "objdb/result.h"

/// Units of measure. Everything is stored in SI; units are read, checked for dimension, and converted once.
namespace objdb {

/// Exponents of metre, kilogram, second, ampere, kelvin, candela, radian. The angle counts as a dimension of its own,
/// so that a length is never taken for an angle.
struct Dimension {
  std::array<std::int8_t, 7> exponents{};
  bool operator==(const Dimension&) const = default;
};

/// A unit: a number in it times `multiply` over `divide` is the number in SI. Both are kept, so that 7cm is the
/// double nearest to 0.07 (7 / 100 rounds once; 7 * 0.01 rounds twice).
struct Unit {
  Dimension dimension;
  double multiply = 1;
  double divide = 1;

  bool is_si() const { return multiply == 1 && divide == 1; }
  double to_si(double value) const { return value * multiply / divide; }
};

/// Reads a unit such as `cm`, `m/s`, `m/s^2`, `kN*m`. No value: unknown, or an exponent beyond 9. The empty text is the
/// pure number.
std::optional<Unit> parse_unit(std::string_view text);

/// The usual SI name of a dimension: "m", "N", "m/s^2"; empty for a pure number.
std::string si_name(const Dimension& dimension);

/// Reads a number with an optional unit: `4cm`, `-1.5e3`, `30deg`. A bare number is in SI and always fits.
/// Errors: type (no number: also nan, inf, 0x1p3, 1,5), range (beyond a double), unit (unknown, or of another
/// dimension).
Result<double> parse_real(std::string_view text, const Dimension& dimension);

/// Reads a whole number that fits 64 bits. Errors: type, range.
Result<std::int64_t> parse_integer(std::string_view text);

}  // namespace objdb
