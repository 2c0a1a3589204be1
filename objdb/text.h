#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "objdb/result.h"

/// Lines, words, numbers and patterns: the letters of the language (docs/language.md, "Lines").
namespace objdb {

/// The longest line, with its newline; the longest name and path.
constexpr std::size_t longest_line = 65'536, longest_name = 255, longest_path = 4'095;

/// One word of a line. `text` points into the line, or into the LineWords that split it when escapes were undone.
struct Word {
  std::string_view text;
  int column = 0;       ///< 1-based byte of its first character in the line
  bool quoted = false;  ///< "..." : never a keyword, never a comment
};

using Words = std::span<const Word>;

/// A line split into its tag and words. Reused from line to line, so that a line costs no allocation.
class LineWords {
 public:
  /// Splits `line` (without its newline). A comment and surrounding blanks are dropped; an empty line has no words.
  /// Errors (syntax): control bytes other than tab, invalid UTF-8, an unbalanced quote, an unknown escape, letters that
  /// touch a closing quote. The words point into `line`, which must outlive them.
  Status split(std::string_view line);

  std::string_view tag() const { return tag_; }  ///< without its '@'; empty when the line has none
  Words words() const { return words_; }
  bool empty() const { return words_.empty(); }

 private:
  // the usual line: bare words of ASCII, blanks between them. False: look at it with care
  bool split_plain(std::string_view line);
  Status split_any(std::string_view line);
  Status quoted_word(std::string_view line, std::size_t& at);

  std::string_view tag_;
  std::vector<Word> words_;
  std::string unescaped_;
};

/// `text` as one word that reads back: bare when it can be, quoted otherwise.
std::string quote(std::string_view text);
void append_quoted(std::string& out, std::string_view text);

/// `text` as it stands in a sentence: as quote() says it, cut after some 60 bytes.
std::string shown(std::string_view text);

/// The shortest decimal that reads back to the same bits; '.' whatever the locale.
void append_number(std::string& out, double value);
void append_number(std::string& out, std::int64_t value);

/// Appends the lowest digits of a number, hexadecimal.
void append_hexadecimal(std::string& out, std::uint64_t value, int digits = 16);
std::string number(double value);

/// True for valid UTF-8 without control bytes other than tab and newline: what a word can hold.
bool is_text(std::string_view text);
/// True for name = [A-Za-z_][A-Za-z0-9_]*.
bool is_name(std::string_view text);
/// True for names joined by '/'.
bool is_path(std::string_view text);
/// True when `text` holds a '*'.
bool is_pattern(std::string_view text);
/// Does `text` fit `pattern`? '*' stands for any characters but '/', "**" for any at all.
bool matches(std::string_view pattern, std::string_view text);

/// The candidate that `text` most likely was meant to be (edit distance at most a third of its length), the first of
/// equals, or "". Texts beyond 100 bytes are never looked at.
std::string_view nearest(std::string_view text, std::span<const std::string_view> candidates);
/// ", did you mean X?" or "".
std::string did_you_mean(std::string_view text, std::span<const std::string_view> candidates);

}  // namespace objdb
