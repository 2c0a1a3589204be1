#include "objdb/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace objdb {
namespace {

Error syntax_error(std::string sentence, std::size_t at) {
  return {ErrorKind::syntax, std::move(sentence), static_cast<int>(at) + 1};
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string hexadecimal(unsigned char byte) {
  std::string out = "0x";
  append_hexadecimal(out, byte, 2);
  return out;
}

// length of the valid UTF-8 sequence at `at`, 0 when there is none (RFC 3629, table of well-formed sequences)
std::size_t utf8_length(std::string_view s, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < s.size() ? static_cast<unsigned char>(s[i]) : 0u; };
  const auto tail = [&](std::size_t i) { return (byte(i) & 0xc0u) == 0x80u; };
  const unsigned first = byte(at), second = byte(at + 1);
  if (first >= 0xc2 && first <= 0xdf) return tail(at + 1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const unsigned low = first == 0xe0 ? 0xa0u : 0x80u, high = first == 0xed ? 0x9fu : 0xbfu;
    return second >= low && second <= high && tail(at + 2) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const unsigned low = first == 0xf0 ? 0x90u : 0x80u, high = first == 0xf4 ? 0x8fu : 0xbfu;
    return second >= low && second <= high && tail(at + 2) && tail(at + 3) ? 4 : 0;
  }
  return 0;
}

// control bytes and broken UTF-8 are refused wherever they stand, also inside quotes and comments
Status check_bytes(std::string_view line) {
  for (std::size_t i = 0; i < line.size();) {
    // eight printable bytes at once: none has its top bit set, is below 0x20 or is 0x7f
    // (the carry of a byte that fails may only let others fail, which are then looked at one by one)
    while (i + 8 <= line.size()) {
      std::uint64_t word = 0;
      std::memcpy(&word, line.data() + i, 8);
      constexpr std::uint64_t each = 0x0101010101010101ull;
      if (((word | (word - 0x20 * each) | (word + each)) & 0x80 * each) != 0) break;
      i += 8;
    }
    if (i == line.size()) break;
    const auto byte = static_cast<unsigned char>(line[i]);
    if (byte >= 0x20 && byte < 0x7f) {
      ++i;
    } else if (byte == '\t') {
      ++i;
    } else if (byte < 0x80) {
      return syntax_error("control byte " + hexadecimal(byte) + ", expected printable text", i);
    } else if (const std::size_t length = utf8_length(line, i)) {
      i += length;
    } else {
      return syntax_error("byte " + hexadecimal(byte) + " is not valid UTF-8", i);
    }
  }
  return {};
}

// what 16 bytes are, a bit each: part of a bare word of ASCII; a blank. Neither: the line is looked at with care
struct Kinds {
  std::uint64_t word = 0, blank = 0;
};

Kinds kinds_of(const char* bytes) {
#ifdef __SSE2__
  // bytes beyond ASCII are negative
  const __m128i all = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes));
  const auto equal = [&](char c) { return _mm_cmpeq_epi8(all, _mm_set1_epi8(c)); };
  const __m128i graphic = _mm_cmpgt_epi8(all, _mm_set1_epi8(' '));
  const __m128i word = _mm_andnot_si128(_mm_or_si128(equal('"'), equal('\x7f')), graphic);
  const auto bits = [](__m128i each) { return static_cast<std::uint64_t>(_mm_movemask_epi8(each)); };
  return {bits(word), bits(_mm_or_si128(equal(' '), equal('\t')))};
#else
  Kinds out;
  for (unsigned i = 0; i < 16; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    out.word |= std::uint64_t{byte > 0x20 && byte < 0x7f && byte != '"'} << i;
    out.blank |= std::uint64_t{is_blank(bytes[i])} << i;
  }
  return out;
#endif
}

// the same of up to 64 bytes; nothing stands behind the last
Kinds kinds_of(std::string_view bytes) {
  Kinds out;
  const auto take = [&](const char* from, std::size_t at, std::size_t skipped) {
    const Kinds each = kinds_of(from);
    out.word |= each.word >> skipped << at;
    out.blank |= each.blank >> skipped << at;
  };
  std::size_t at = 0;
  for (; at + 16 <= bytes.size(); at += 16) take(bytes.data() + at, at, 0);
  if (at == bytes.size()) return out;
  if (at > 0) {
    // the last 16, some of which were looked at
    take(bytes.data() + bytes.size() - 16, at, at + 16 - bytes.size());
  } else {
    std::array<char, 16> few{};
    std::memcpy(few.data(), bytes.data(), bytes.size());
    take(few.data(), 0, 0);
  }
  return out;
}

}  // namespace

Status LineWords::split(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return split_plain(line) ? Status() : split_any(line);
}

bool LineWords::split_plain(std::string_view line) {
  tag_ = {};
  words_.clear();
  std::size_t start = 0;
  std::uint64_t inside = 0;  // 1: a word has begun at `start`
  const auto close = [&](std::size_t end) {
    const std::string_view text = line.substr(start, end - start);
    if (text[0] == '#') return false;
    if (text[0] != '@' || !words_.empty()) {
      words_.push_back({text, static_cast<int>(start) + 1, false});
      return true;
    }
    if (!tag_.empty() || text.size() == 1) return false;
    tag_ = text.substr(1);
    return true;
  };
  for (std::size_t block = 0; block < line.size(); block += 64) {
    const std::string_view bytes = line.substr(block, 64);
    const Kinds kinds = kinds_of(bytes);
    if (((kinds.word | kinds.blank) + 1) << (64 - bytes.size()) != 0) return false;
    // where words begin and end, by turns
    for (std::uint64_t edges = kinds.word ^ (kinds.word << 1 | inside); edges != 0; edges &= edges - 1) {
      const std::size_t at = block + static_cast<std::size_t>(std::countr_zero(edges));
      if (at >= line.size()) break;
      if (inside == 0)
        start = at;
      else if (!close(at))
        return false;
      inside ^= 1;
    }
  }
  if (inside != 0 && !close(line.size())) return false;
  return tag_.empty() || !words_.empty();
}

Status LineWords::split_any(std::string_view line) {
  tag_ = {};
  words_.clear();
  unescaped_.clear();
  if (Status bytes = check_bytes(line); !bytes) return bytes;

  std::size_t at = 0;
  while (true) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (at == line.size() || line[at] == '#') break;
    if (line[at] == '"') {
      if (Status word = quoted_word(line, at); !word) return word;
      continue;
    }
    const std::size_t start = at;
    while (at < line.size() && !is_blank(line[at])) {
      if (line[at] == '"') return syntax_error("a quote inside a bare word, expected a blank before it", at);
      ++at;
    }
    const std::string_view text = line.substr(start, at - start);
    if (words_.empty() && tag_.empty() && text[0] == '@') {
      if (text.size() == 1) return syntax_error("an empty tag, expected a word after '@'", start);
      tag_ = text.substr(1);
    } else {
      words_.push_back({text, static_cast<int>(start) + 1, false});
    }
  }
  if (!tag_.empty() && words_.empty()) return syntax_error("a tag without a command", 0);
  return {};
}

Status LineWords::quoted_word(std::string_view line, std::size_t& at) {
  const std::size_t open = at++;
  const std::size_t close = line.find_first_of("\"\\", at);
  if (close == std::string_view::npos) return syntax_error("a quote is not closed", open);

  std::string_view text;
  if (line[close] == '"') {
    text = line.substr(at, close - at);
    at = close + 1;
  } else {
    // undone escapes live in one buffer that is never moved: it never outgrows the line
    unescaped_.reserve(line.size());
    const std::size_t start = unescaped_.size();
    while (true) {
      if (at == line.size()) return syntax_error("a quote is not closed", open);
      const char c = line[at];
      if (c == '"') break;
      if (c != '\\') {
        unescaped_ += c;
        ++at;
        continue;
      }
      const char escape = at + 1 < line.size() ? line[at + 1] : '\0';
      switch (escape) {
        case 'n': unescaped_ += '\n'; break;
        case 't': unescaped_ += '\t'; break;
        case '"':
        case '\\': unescaped_ += escape; break;
        case '\0': return syntax_error("a quote is not closed", open);
        default: {
          // the whole character, which may have several bytes
          const std::size_t length = std::max<std::size_t>(utf8_length(line, at + 1), 1);
          return syntax_error(
              "unknown escape " + std::string(line.substr(at, 1 + length)) + R"(, expected \" \\ \n or \t)", at);
        }
      }
      at += 2;
    }
    ++at;
    text = std::string_view(unescaped_).substr(start);
  }
  if (at < line.size() && !is_blank(line[at])) return syntax_error("expected a blank after the closing quote", at);
  words_.push_back({text, static_cast<int>(open) + 1, true});
  return {};
}

void append_quoted(std::string& out, std::string_view text) {
  const auto breaks = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '"' || c == '\\'; };
  const bool bare = !text.empty() && text != "-" && text[0] != '#' && text[0] != '@' &&
                    std::none_of(text.begin(), text.end(), breaks);
  if (bare) {
    out += text;
    return;
  }
  out += '"';
  for (const char c : text) {
    if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (c == '"' || c == '\\')
      (out += '\\') += c;
    else
      out += c;
  }
  out += '"';
}

std::string quote(std::string_view text) {
  std::string out;
  append_quoted(out, text);
  return out;
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 60;
  if (text.size() <= longest) return quote(text);
  // not in the middle of a character
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;
  return quote(std::string(text.substr(0, end)) + "...");
}

void append_number(std::string& out, double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  out.append(buffer.data(), end);
}

void append_hexadecimal(std::string& out, std::uint64_t value, int digits) {
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) out += "0123456789abcdef"[(value >> shift) & 15];
}

void append_number(std::string& out, std::int64_t value) {
  std::array<char, 24> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  out.append(buffer.data(), end);
}

std::string number(double value) {
  std::string out;
  append_number(out, value);
  return out;
}

bool is_text(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (!check_bytes(text.substr(at, end - at))) return false;
    at = end + 1;
  }
  return true;
}

bool is_name(std::string_view text) {
  if (text.empty() || (text[0] >= '0' && text[0] <= '9')) return false;
  return std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

bool is_path(std::string_view text) {
  while (true) {
    const std::size_t slash = text.find('/');
    if (!is_name(text.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    text.remove_prefix(slash + 1);
  }
}

bool is_pattern(std::string_view text) { return text.find('*') != std::string_view::npos; }

bool matches(std::string_view pattern, std::string_view text) {
  // greedy matching with one point of return for '*' and one for "**": linear in practice, never exponential
  constexpr std::size_t none = std::string_view::npos;
  std::size_t p = 0, t = 0, star_p = none, star_t = 0, deep_p = none, deep_t = 0;
  while (true) {
    if (p < pattern.size() && pattern[p] == '*') {
      const bool deep = p + 1 < pattern.size() && pattern[p + 1] == '*';
      (deep ? deep_p : star_p) = p + (deep ? 2 : 1);
      (deep ? deep_t : star_t) = t;
      if (deep) star_p = none;
      p += deep ? 2 : 1;
    } else if (p == pattern.size() && t == text.size()) {
      return true;
    } else if (p < pattern.size() && t < text.size() && pattern[p] == text[t]) {
      ++p, ++t;
    } else if (star_p != none && star_t < text.size() && text[star_t] != '/') {
      p = star_p;
      t = ++star_t;
    } else if (deep_p != none && deep_t < text.size()) {
      p = deep_p;
      t = ++deep_t;
      star_p = none;
    } else {
      return false;
    }
  }
}

std::string_view nearest(std::string_view text, std::span<const std::string_view> candidates) {
  std::string_view best;
  // nobody mistypes a text of that length by a third
  constexpr std::size_t longest = 100;
  if (text.size() > longest) return best;
  std::size_t best_distance = text.size() / 3 + 1;
  std::vector<std::size_t> row, above, next;
  for (const std::string_view candidate : candidates) {
    const std::size_t longer = std::max(text.size(), candidate.size()),
                      shorter = std::min(text.size(), candidate.size());
    if (longer - shorter >= best_distance) continue;
    // letters left out, added, changed, or two swapped (optimal string alignment), one row at a time
    row.resize(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    above.assign(row.size(), longest);
    for (std::size_t i = 0; i < text.size(); ++i) {
      next.assign(row.size(), i + 1);
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        next[j + 1] = std::min({row[j] + (text[i] == candidate[j] ? 0 : 1), next[j] + 1, row[j + 1] + 1});
        if (i > 0 && j > 0 && text[i] == candidate[j - 1] && text[i - 1] == candidate[j])
          next[j + 1] = std::min(next[j + 1], above[j - 1] + 1);
      }
      above.swap(row);
      row.swap(next);
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view text, std::span<const std::string_view> candidates) {
  const std::string_view best = nearest(text, candidates);
  return best.empty() ? std::string() : ", did you mean " + std::string(best) + "?";
}

}  // namespace objdb
