#include "objdb/value.h"

#include <bit>
#include <cstring>

namespace objdb {

std::string_view name_of(Kind kind) {
  static constexpr std::array<std::string_view, 8> names = {"bool", "int",  "real", "vec3",
                                                            "quat", "word", "text", "ref"};
  return names[static_cast<std::size_t>(kind)];
}

int words_of(Kind kind) { return kind == Kind::vec3 ? 3 : kind == Kind::quat ? 4 : 1; }

void swap_values(Value& a, Value& b) {
  if (a.index() != b.index()) return a.swap(b);
  switch (a.index()) {
    case 0: return std::swap(*std::get_if<0>(&a), *std::get_if<0>(&b));
    case 1: return std::swap(*std::get_if<1>(&a), *std::get_if<1>(&b));
    case 2: return std::swap(*std::get_if<2>(&a), *std::get_if<2>(&b));
    case 3: return std::swap(*std::get_if<3>(&a), *std::get_if<3>(&b));
    default: a.swap(b);
  }
}

bool same_bits(const Value& a, const Value& b) {
  if (a.index() != b.index()) return false;
  // word by word, without a call
  const auto same = [](const auto* left, const auto* right) {
    using Bits = std::array<std::uint64_t, sizeof *left / sizeof(std::uint64_t)>;
    return std::bit_cast<Bits>(*left) == std::bit_cast<Bits>(*right);
  };
  switch (a.index()) {
    case 0: return same(std::get_if<0>(&a), std::get_if<0>(&b));
    case 1: return same(std::get_if<1>(&a), std::get_if<1>(&b));
    case 2: return same(std::get_if<2>(&a), std::get_if<2>(&b));
    case 3: return same(std::get_if<3>(&a), std::get_if<3>(&b));
    default: break;
  }
  return a == b;
}

std::uint64_t hash_word(std::uint64_t hash, std::uint64_t word) {
  // one round of the splitmix64 finalizer (Steele, Lea & Flood 2014)
  hash = (hash ^ word) + 0x9e3779b97f4a7c15ull;
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
  return hash ^ (hash >> 31);
}

std::uint64_t hash_text(std::string_view text, std::uint64_t seed) {
  std::uint64_t hash = hash_word(seed, text.size());
  while (!text.empty()) {
    // eight bytes at a time, little end first whatever the machine
    std::uint64_t word = 0;
    const std::size_t n = text.size() < 8 ? text.size() : 8;
    if (n == 8 && std::endian::native == std::endian::little)
      std::memcpy(&word, text.data(), 8);
    else
      for (std::size_t i = 0; i < n; ++i) word |= std::uint64_t{static_cast<unsigned char>(text[i])} << (8 * i);
    hash = hash_word(hash, word);
    text.remove_prefix(n);
  }
  return hash;
}

}  // namespace objdb
