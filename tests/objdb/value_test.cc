#include "objdb/value.h"

#include <set>

#include <gtest/gtest.h>

namespace objdb {
namespace {

// one value of every alternative, and a second one that differs in the least thing
const std::pair<Value, Value> pairs[] = {
    {std::int64_t{0}, std::int64_t{1}},
    {0.0, -0.0},
    {Vec3{0, 0, 0}, Vec3{0, 0, -0.0}},
    {Quat{1, 0, 0, 0}, Quat{1, 0, 0, -0.0}},
    {std::string("a"), std::string("b")},
    {std::vector<std::int64_t>{1, 2}, std::vector<std::int64_t>{1, 3}},
    {std::vector<double>{1, 0}, std::vector<double>{1, -0.0}},
    {std::vector<std::string>{"a", ""}, std::vector<std::string>{"a"}},
};

TEST(Value, IsTheSameWhenItsBitsAre) {
  ASSERT_EQ(std::size(pairs), std::variant_size_v<Value>);
  for (const auto& [a, b] : pairs) {
    EXPECT_TRUE(same_bits(a, Value(a)));
    EXPECT_FALSE(same_bits(a, b));
    for (const auto& [c, d] : pairs)
      if (a.index() != c.index()) {
        EXPECT_FALSE(same_bits(a, c));
      }
  }
  EXPECT_TRUE(same_bits(std::vector<double>{}, std::vector<double>{}));
}

// written down once: another number here would make worlds of other builds look different
TEST(Hash, IsTheSameOnEveryMachine) {
  // splitmix64 of seed 0 (Steele, Lea & Flood 2014; test vector of the reference implementation by Vigna)
  EXPECT_EQ(hash_word(0, 0), 0xe220a8397b1dcdafull);
  EXPECT_EQ(hash_text(""), hash_word(0, 0));
  EXPECT_EQ(hash_text("abc"), hash_word(hash_word(0, 3), 0x636261));
  EXPECT_EQ(hash_text("abcdefghi"), hash_word(hash_word(hash_word(0, 9), 0x6867666564636261ull), 0x69));
}

TEST(Hash, TellsTextsApart) {
  std::set<std::uint64_t> seen;
  std::string text;
  for (int i = 0; i < 40; ++i, text += '\0') EXPECT_TRUE(seen.insert(hash_text(text)).second) << i << " zero bytes";
  for (std::size_t at = 0; at < 20; ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped(20, 'x');
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << bit));
      EXPECT_TRUE(seen.insert(hash_text(flipped)).second);
    }
}

TEST(Kind, HasItsWord) {
  const Kind kinds[] = {Kind::boolean, Kind::integer, Kind::real, Kind::vec3,
                        Kind::quat,    Kind::word,    Kind::text, Kind::ref};
  const std::string_view names[] = {"bool", "int", "real", "vec3", "quat", "word", "text", "ref"};
  for (std::size_t i = 0; i < std::size(kinds); ++i) EXPECT_EQ(name_of(kinds[i]), names[i]);
  EXPECT_EQ(words_of(Kind::vec3), 3);
  EXPECT_EQ(words_of(Kind::quat), 4);
  EXPECT_EQ(words_of(Kind::text), 1);
}

}  // namespace
}  // namespace objdb
