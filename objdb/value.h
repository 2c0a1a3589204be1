#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "objdb/numbers.h"
#include "objdb/result.h"

namespace objdb {

using Vec3 = std::array<double, 3>;
using Quat = std::array<double, 4>;  ///< w x y z

/// An object's number: given in order of creation, never given twice, 0 for "no object".
using ObjectId = std::uint32_t;

/// What one element of a field is.
enum class Kind : std::uint8_t { boolean, integer, real, vec3, quat, word, text, ref };

/// The kind's word in the language: bool int real vec3 quat word text ref.
std::string_view name_of(Kind kind);

/// Words that one element of a kind takes on a line: 3 for vec3, 4 for quat, else 1.
int words_of(Kind kind);

/// What a field holds. The field's kind says how to read it:
///   std::int64_t               bool (0, 1), int, word (index into the field's words), ref (ObjectId)
///   double, Vec3, Quat         real, vec3, quat
///   std::string                text
///   std::vector<std::int64_t>  arrays of bool, int, word, ref
///   Numbers                    arrays of real, vec3, quat: flat, 1, 3 or 4 numbers an element
///   std::vector<std::string>   arrays of text
using Value = std::variant<std::int64_t, double, Vec3, Quat, std::string, std::vector<std::int64_t>, Numbers,
                           std::vector<std::string>>;

/// True when both hold the same bits (so that -0 and 0 differ, as they print differently).
bool same_bits(const Value& a, const Value& b);

/// Swaps; small values of the same alternative without a visit.
void swap_values(Value& a, Value& b);

/// 64 bits of `text`; the same on every machine and in every build.
std::uint64_t hash_text(std::string_view text, std::uint64_t seed = 0);
/// Mixes one 64-bit word into a hash.
std::uint64_t hash_word(std::uint64_t hash, std::uint64_t word);

}  // namespace objdb
