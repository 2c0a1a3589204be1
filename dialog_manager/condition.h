#pragma once

#include <optional>
#include <string>

#include "objdb/statement.h"

namespace manager {

/// `FIELD OP VALUE [+- TOL]`, OP one of == != < <= > >=; FIELD is PATH.FIELD, PATH.FIELD[n] or PATTERN.FIELD (then it
/// must hold for every object that fits). It is kept as text and read anew each time, since objects come and go.
class Condition {
 public:
  /// The words of a condition; how many of them it took is left in `used`. Errors as of get, plus syntax.
  static objdb::Result<Condition> parse(const objdb::Database& world, objdb::Words words, const objdb::Scope& scope,
                                        std::size_t& used);

  /// Does it hold? Errors: unknown, when an object or field is gone.
  objdb::Result<bool> holds(const objdb::Database& world) const;
  /// "ball.radius is 0.3, expected < 0.2": what stands in its way.
  std::string failure(const objdb::Database& world) const;
  const std::string& text() const { return text_; }

 private:
  enum class Compare { equal, unequal, less, less_equal, greater, greater_equal };

  objdb::Result<bool> check(const objdb::Database& world, std::string* failure) const;

  std::string text_;
  std::string target_;
  std::string expected_;             // operator and value, as said
  std::vector<std::string> values_;  // words of the value
  std::vector<bool> quoted_;
  Compare compare_ = Compare::equal;
  std::string tolerance_;  // "" or a number with unit
  objdb::Scope scope_;
  int column_ = 0;
};

}  // namespace manager
