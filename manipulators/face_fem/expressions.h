#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "objdb/result.h"

namespace face {

/// Intensities of places of action units: what an expression is made of.
using Parts = std::vector<std::pair<int, double>>;  ///< place (action_units.h) and intensity 0..1

/// An expression that every face knows.
struct NamedExpression {
  std::string_view name;
  enum class Kind { expression, viseme } kind;
  std::string_view units;  ///< "AU6=0.7 AU12=1": words of units and intensities, a missing one is 1
  double onset = 0;        ///< usual rise, seconds; 0: the face's own
  double offset = 0;       ///< usual fall, seconds; 0: the face's own
  std::string_view doc;
};

/// All of them: emotions by their prototypes (py-feat's reference table, after Ekman and Friesen), then visemes.
std::span<const NamedExpression> named_expressions();

/// The one of that name, null for none.
const NamedExpression* find_expression(std::string_view name);

/// One word NAME=AMOUNT, or NAME for 1, split. Errors: syntax (no name), type (no number), range (outside 0..1).
struct Amount {
  std::string_view name;
  double amount;
};
objdb::Result<Amount> parse_amount(std::string_view word);

/// Parts of words such as "AU12L=0.4" or of the name of a named expression, scaled by their amounts and added up, at
/// most 1 each. Errors as of parse_amount, and unknown with `did you mean`.
objdb::Result<Parts> parse_parts(std::span<const std::string_view> words);

/// Parts of a named expression.
Parts parts_of(const NamedExpression& expression);

/// The names of expressions and units, for completion of errors.
std::vector<std::string_view> all_names();

}  // namespace face
