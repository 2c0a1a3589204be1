#include "objdb/text.h"

#include <bit>
#include <charconv>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

namespace objdb {
namespace {

std::vector<std::string> split(std::string_view line) {
  LineWords words;
  const Status status = words.split(line);
  EXPECT_TRUE(status.ok()) << line << ": " << status.error().sentence;
  std::vector<std::string> out;
  for (const Word& word : words.words()) out.emplace_back(word.text);
  return out;
}

using Texts = std::vector<std::string>;

TEST(Line, IsSplitAtBlanks) {
  EXPECT_EQ(split(""), Texts());
  EXPECT_EQ(split(" \t "), Texts());
  EXPECT_EQ(split("set a.b 1 2"), Texts({"set", "a.b", "1", "2"}));
  EXPECT_EQ(split("\tset   a.b\t1 "), Texts({"set", "a.b", "1"}));
  EXPECT_EQ(split("set a.b 1\r"), Texts({"set", "a.b", "1"}));
  EXPECT_EQ(split("\r"), Texts());
}

TEST(Line, EndsAtAComment) {
  EXPECT_EQ(split("# all"), Texts());
  EXPECT_EQ(split("  # \"not a quote"), Texts());
  EXPECT_EQ(split("set a#b #c d"), Texts({"set", "a#b"}));
  EXPECT_EQ(split("set \"#a\" b"), Texts({"set", "#a", "b"}));
}

TEST(Line, UndoesEscapesInQuotes) {
  EXPECT_EQ(split(R"(echo "")"), Texts({"echo", ""}));
  EXPECT_EQ(split(R"(echo "two words" "\"\\\n\t" x\y)"), Texts({"echo", "two words", "\"\\\n\t", "x\\y"}));
  EXPECT_EQ(split("echo \"a\tb\""), Texts({"echo", "a\tb"}));
  // many escaped words: none may move when the next one is undone
  std::string line = "echo";
  Texts expected = {"echo"};
  for (int i = 0; i < 2000; ++i) {
    line += " \"\\\\" + std::to_string(i) + "\"";
    expected.push_back("\\" + std::to_string(i));
  }
  EXPECT_EQ(split(line), expected);
}

TEST(Line, HasATagInFront) {
  LineWords words;
  ASSERT_TRUE(words.split("  @17 get @b"));
  EXPECT_EQ(words.tag(), "17");
  ASSERT_EQ(words.words().size(), 2u);
  EXPECT_EQ(words.words()[1].text, "@b");
  ASSERT_TRUE(words.split("\"@17\" get"));
  EXPECT_EQ(words.tag(), "");
  ASSERT_TRUE(words.split("get"));
  EXPECT_EQ(words.tag(), "") << "the tag of the line before is forgotten";
}

TEST(Line, KnowsTheColumnOfEveryWord) {
  LineWords words;
  ASSERT_TRUE(words.split(" @t set  \"a\\n\" b\t c"));
  std::vector<int> columns;
  for (const Word& word : words.words()) columns.push_back(word.column);
  EXPECT_EQ(columns, std::vector<int>({5, 10, 16, 19}));
}

struct Refusal {
  std::string line;
  int column;
};

TEST(Line, IsRefusedAtTheByteAtFault) {
  const Refusal refusals[] = {{"set \"a", 5},
                              {"set \"a\\", 5},
                              {"set \"a\\\"", 5},
                              {"set \"a\"b", 8},
                              {"set a\"b\"", 6},
                              {"set \"a\\qb\"", 7},
                              {"set \"a\\é\"", 7},
                              {"@ set", 1},
                              {"@1", 1},
                              {"set \x01", 5},
                              {std::string("a\0b", 3), 2},
                              {"a\rb", 2},
                              {"a\x7f", 2},
                              {"a\x80", 2},
                              {"\xc3", 1},
                              {"a\xc3(", 2},
                              {"\xc0\x80", 1},
                              {"\xe0\x80\x80", 1},
                              {"\xed\xa0\x80", 1},
                              {"\xf4\x90\x80\x80", 1},
                              {"\xf0\x80\x80\x80", 1},
                              {"\xf8\x88\x80\x80", 1},
                              {"\xff", 1},
                              {"a # \x02", 5},
                              {"\xe2\x82", 1}};
  for (const Refusal& refusal : refusals) {
    LineWords words;
    const Status status = words.split(refusal.line);
    ASSERT_FALSE(status.ok()) << refusal.line;
    EXPECT_EQ(status.error().kind, ErrorKind::syntax);
    EXPECT_EQ(status.error().column, refusal.column) << refusal.line << ": " << status.error().sentence;
    EXPECT_FALSE(status.error().sentence.empty());
    EXPECT_TRUE(words.split("set a.b 1").ok()) << "a good line works at once";
  }
}

// every byte, first, in the middle, last: a word, a blank, a comment, a quote, a tag or an error, never anything else
TEST(Line, TakesOrRefusesEveryByteEverywhere) {
  const std::string_view around[][2] = {{"", "x"}, {"x", "x"}, {"x", ""}, {"", ""}, {"\"x", "x\""}, {"# ", " x"}};
  for (int byte = 0; byte < 256; ++byte) {
    const bool printable = byte >= 0x20 && byte < 0x7f;
    for (std::size_t place = 0; place < std::size(around); ++place) {
      const std::string line = std::string(around[place][0]) + static_cast<char>(byte) + std::string(around[place][1]);
      LineWords words;
      const Status status = words.split(line);
      bool good = printable || byte == '\t' || (byte == '\r' && line.back() == '\r');
      const bool bare = place < 4;
      if (byte == '"' && place != 5) good = false;
      if (byte == '\\' && place == 4) good = false;
      if (byte == '@' && bare && (place == 0 || place == 3)) good = false;
      EXPECT_EQ(status.ok(), good) << "byte " << byte << " place " << place;
    }
  }
}

// all sequences of up to three bytes against the definition of UTF-8: decode, not overlong, no surrogate
bool decodes(std::string_view s) {
  for (std::size_t i = 0; i < s.size();) {
    const auto lead = static_cast<unsigned char>(s[i]);
    const int length = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc0 ? 2 : 0;
    if (length == 0 || lead >= 0xf8 || i + static_cast<std::size_t>(length) > s.size()) return false;
    std::uint32_t code = length == 1 ? lead : lead & (0x7fu >> length);
    for (int k = 1; k < length; ++k) {
      const auto tail = static_cast<unsigned char>(s[i + static_cast<std::size_t>(k)]);
      if ((tail >> 6) != 2) return false;
      code = code << 6 | (tail & 0x3fu);
    }
    static constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < least[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return false;
    i += static_cast<std::size_t>(length);
  }
  return true;
}

TEST(Text, IsUtf8) {
  // leads and tails around every border of the table, two to four bytes
  const unsigned char tails[] = {0x41, 0x7e, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf, 0xc0, 0xff};
  for (int lead = 0x80; lead < 256; ++lead)
    for (const unsigned char a : tails)
      for (const unsigned char b : tails)
        for (const unsigned char c : tails) {
          const char bytes[] = {static_cast<char>(lead), static_cast<char>(a), static_cast<char>(b),
                                static_cast<char>(c)};
          for (std::size_t n = 1; n <= 4; ++n) {
            const std::string_view text(bytes, n);
            ASSERT_EQ(is_text(text), decodes(text)) << lead << " " << int{a} << " " << int{b} << " " << int{c};
          }
        }
  EXPECT_TRUE(is_text(""));
  EXPECT_TRUE(is_text("a\n\tb\n"));
  EXPECT_FALSE(is_text("a\rb"));
  EXPECT_FALSE(is_text(std::string_view("\0", 1)));
}

TEST(Quote, SplitsBackToTheSameText) {
  std::mt19937_64 random(1);
  const std::string_view pieces[] = {" ", "\t", "\n", "\"", "\\", "#", "@", "-", "a", "1", ".", "/", "*", "é", "𝄞"};
  for (int i = 0; i < 100'000; ++i) {
    std::string text;
    for (std::size_t n = random() % 6; n > 0; --n) text += pieces[random() % std::size(pieces)];
    const std::string line = "echo " + quote(text) + " " + quote(text);
    ASSERT_EQ(split(line), Texts({"echo", text, text})) << line;
    ASSERT_EQ(split(quote(text)), Texts({text})) << "also as the first word";
  }
}

TEST(Quote, LeavesPlainWordsBare) {
  EXPECT_EQ(quote("abc"), "abc");
  EXPECT_EQ(quote("a#b"), "a#b");
  EXPECT_EQ(quote(""), "\"\"");
  EXPECT_EQ(quote("-"), "\"-\"");
  EXPECT_EQ(quote("two words"), "\"two words\"");
  EXPECT_EQ(quote("a\n\"\\"), R"("a\n\"\\")");
}

TEST(Shown, IsShortAndWhole) {
  EXPECT_EQ(shown("abc"), "abc");
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "é";
  const std::string cut = shown("a" + text);
  EXPECT_LT(cut.size(), 80u);
  EXPECT_TRUE(is_text(cut));
  EXPECT_EQ(shown(std::string(100, '\n')).find('\n'), std::string::npos);
}

double read_back(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc() && end == text.data() + text.size()) << text;
  return value;
}

// a million doubles, bit patterns drawn evenly, so that denormals, huge ones and -0 are among them;
// strtod of the C library is the independent witness
TEST(Number, ReadsBackToTheSameBits) {
  std::mt19937_64 random(2);
  int denormal = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    std::uint64_t bits = random();
    if (i % 16 == 0) bits &= 0x800fffffffffffffull;
    const auto value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) continue;
    denormal += std::fpclassify(value) == FP_SUBNORMAL;
    const std::string text = number(value);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(read_back(text)), bits) << text;
    if (i % 16 <= 1) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)), bits) << text;
    }
    ASSERT_LE(text.size(), 24u) << text;
  }
  EXPECT_GT(denormal, 50'000);
}

TEST(Number, IsTheShortestThatReadsBack) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(-0.0), "-0");
  EXPECT_EQ(number(1e300), "1e+300");
  EXPECT_EQ(number(5e-324), "5e-324");
  EXPECT_EQ(number(100), "100");
  EXPECT_EQ(number(1.0 / 60), "0.016666666666666666");
  // no decimal with fewer digits reads back: 17 significant ones are never undercut by printf with one less
  std::mt19937_64 random(3);
  for (int i = 0; i < 20'000; ++i) {
    const auto value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    const std::string text = number(value);
    int digits = 0;
    for (const char c : text) {
      if (c == 'e') break;
      digits += c >= '0' && c <= '9';
    }
    if (text.find('e') == std::string::npos || digits < 2) continue;
    char shorter[40];
    std::snprintf(shorter, sizeof shorter, "%.*e", digits - 2, value);
    ASSERT_NE(std::strtod(shorter, nullptr), value) << text;
  }
}

TEST(Name, IsLettersDigitsUnderscore) {
  for (int byte = 0; byte < 256; ++byte) {
    const char c = static_cast<char>(byte);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_', digit = c >= '0' && c <= '9';
    EXPECT_EQ(is_name(std::string(1, c)), letter);
    EXPECT_EQ(is_name(std::string("a") + c), letter || digit);
    EXPECT_EQ(is_path(std::string("a") + c + "b"), letter || digit || c == '/');
  }
  EXPECT_FALSE(is_name(""));
  for (const char* bad : {"", "/", "a/", "/a", "a//b", "a/1", "a.b"}) EXPECT_FALSE(is_path(bad)) << bad;
}

// the definition: every way to give the stars something
bool fits(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] != '*') return !text.empty() && pattern[0] == text[0] && fits(pattern.substr(1), text.substr(1));
  const bool deep = pattern.size() > 1 && pattern[1] == '*';
  const std::string_view rest = pattern.substr(deep ? 2 : 1);
  for (std::size_t n = 0;; ++n) {
    if (fits(rest, text.substr(n))) return true;
    if (n == text.size() || (!deep && text[n] == '/')) return false;
  }
}

TEST(Pattern, MatchesAsDefined) {
  std::mt19937_64 random(4);
  int matched = 0;
  for (int i = 0; i < 300'000; ++i) {
    std::string pattern, text;
    for (std::size_t n = random() % 8; n > 0; --n) pattern += "*/ab*"[random() % 5];
    for (std::size_t n = random() % 9; n > 0; --n) text += "/ab"[random() % 3];
    ASSERT_EQ(matches(pattern, text), fits(pattern, text)) << pattern << " on " << text;
    matched += matches(pattern, text);
  }
  EXPECT_GT(matched, 10'000);
}

TEST(Pattern, KeepsItsHeadWithManyStars) {
  std::string pattern, text(2000, 'a');
  for (int i = 0; i < 200; ++i) pattern += "*a";
  EXPECT_FALSE(matches(pattern + "b", text));
  EXPECT_FALSE(matches("**" + pattern + "b", text));
  EXPECT_TRUE(matches("**" + pattern, text));
}

std::size_t distance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  // two letters that changed places are one mistake
  const bool swapped = a.size() > 1 && b.size() > 1 && a[0] == b[1] && a[1] == b[0];
  return std::min({distance(a.substr(1), b) + 1, distance(a, b.substr(1)) + 1,
                   distance(a.substr(1), b.substr(1)) + (a[0] == b[0] ? 0 : 1),
                   swapped ? distance(a.substr(2), b.substr(2)) + 1 : a.size() + b.size()});
}

TEST(Hint, IsTheNearestWord) {
  std::mt19937_64 random(5);
  const auto word = [&] {
    std::string out;
    for (std::size_t n = 1 + random() % 5; n > 0; --n) out += "abc"[random() % 3];
    return out;
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string wanted = word();
    const std::vector<std::string> words = {word(), word(), word()};
    const std::vector<std::string_view> candidates(words.begin(), words.end());
    std::string_view expected;
    std::size_t least = wanted.size() / 3 + 1;
    for (const std::string_view each : candidates)
      if (distance(wanted, each) < least) {
        least = distance(wanted, each);
        expected = each;
      }
    ASSERT_EQ(nearest(wanted, candidates), expected) << wanted << " in " << words[0] << words[1] << words[2];
  }
  const std::vector<std::string_view> fields = {"position", "orientation"};
  EXPECT_EQ(did_you_mean("positon", fields), ", did you mean position?");
  EXPECT_EQ(did_you_mean("xyz", fields), "");
  EXPECT_EQ(did_you_mean(std::string(60'000, 'p'), fields), "");
}

}  // namespace
}  // namespace objdb
