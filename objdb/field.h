#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "objdb/text.h"
#include "objdb/unit.h"
#include "objdb/value.h"

namespace objdb {

class Type;

/// One field of a type, as declared by
///   field TYPE.NAME KIND [UNIT] [= VALUE...] [in LO HI] [of WORD WORD ...] [private|measured] ["doc"]
struct Field {
  static constexpr int scalar = 1;
  static constexpr int any_length = -1;

  std::string name;
  std::string doc;
  Kind kind = Kind::real;
  bool array = false;
  int count = scalar;                 ///< elements: 1, n for KIND[n], any_length for KIND[]
  const Type* ref_type = nullptr;     ///< ref:TYPE; null: any object
  std::vector<Dimension> dimensions;  ///< one for all elements, or one an element ("rad,m,m,rad"); empty: pure numbers
  std::vector<std::string> words;     ///< of a word field
  bool ranged = false;
  double low = 0, high = 0;  ///< SI, both allowed
  Value standard;            ///< the default
  bool is_private = false;   ///< a program's checkpoint state: not part of the hash
  bool measured = false;     ///< a figure of this machine: not part of the hash, never replayed
  bool derived = false;      ///< computed from other fields: cannot be set, not saved
  const Type* owner = nullptr;

  const Dimension& dimension(int element) const;
  std::string unit() const;       ///< SI name(s), "" for pure numbers
  std::string kind_text() const;  ///< "real", "vec3[]", "ref:node[4]"
  bool hashed() const { return !is_private && !measured && !derived; }
  bool holds_refs() const { return kind == Kind::ref; }
  /// Said in a line of its own when all objects are there: references, so that what they name exists, and long arrays,
  /// so that no line grows without limit.
  bool said_later() const { return holds_refs() || count == any_length || count > 64; }

  /// The declaration as a line of the language that reads back to the same field.
  std::string declaration() const;
};

/// Turns words into objects and back, so that values can be read and printed without knowing the database.
class Names {
 public:
  virtual ~Names() = default;
  virtual Result<ObjectId> object(const Word& word, const Type* type) const = 0;
  virtual std::string_view path(ObjectId id) const = 0;
};

/// Reads the words of one whole value of `field`. Errors: syntax (too few or many words), type, unit, range, unknown.
Result<Value> parse_value(const Field& field, Words words, const Names& names);

/// Reads a value into `out`, which keeps its storage; on error `out` is untouched.
Status parse_value_into(const Field& field, Words words, const Names& names, Value& out);

/// How many words a value of `field` takes; -1 when it may be any number.
int word_count(const Field& field);

/// Appends the value as words that read back to the same bits: `0 0.3 1.5`, `"two words"`, `-` for no object
/// and for an array without elements.
void append_value(std::string& out, const Field& field, const Value& value, const Names& names);

/// Elements of the value: 1 for a scalar.
std::size_t element_count(const Field& field, const Value& value);
/// Appends element `index` alone.
void append_element(std::string& out, const Field& field, const Value& value, std::size_t index, const Names& names);

/// A value of the field's shape that is no wish of anyone: 0, the first word, no object, an empty array.
Value zero_value(const Field& field);

/// Checks range and finiteness of a value that did not come from text.
Status check_value(const Field& field, const Value& value);

}  // namespace objdb
