#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace manager {

/// A number of digits alone; nothing when there is anything else, or too many of them.
inline std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace manager
