#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace manager {

/// A number of digits alone; nothing when there is anything else, or too many of them.
inline std::optional<std::uint64_t> parse_count(std::string_view text, int base = 10) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The number of "KEY=NUMBER", where `key` is "KEY=".
inline std::optional<std::uint64_t> parse_count_of(std::string_view key, std::string_view word, int base = 10) {
  return word.starts_with(key) ? parse_count(word.substr(key.size()), base) : std::nullopt;
}

}  // namespace manager
