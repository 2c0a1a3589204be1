#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace manager {

/// The accepted lines that changed the world, the latest of them, by number: what `why` tells.
class LineLog {
 public:
  struct Line {
    std::uint64_t number = 0;
    std::string text;
  };

  /// The number of this line; numbers start at 1.
  std::uint64_t add(std::string_view text) {
    const std::uint64_t number = next_++;
    if (lines_.size() < kept) lines_.emplace_back();
    Line& line = lines_[(number - 1) % kept];
    line.number = number;
    line.text.assign(text);
    return number;
  }
  /// Null when it is no longer kept.
  const Line* find(std::uint64_t number) const {
    const std::size_t place = (number - 1) % kept;
    return number > 0 && place < lines_.size() && lines_[place].number == number ? &lines_[place] : nullptr;
  }

 private:
  static constexpr std::size_t kept = 1 << 16;
  std::vector<Line> lines_;
  std::uint64_t next_ = 1;
};

}  // namespace manager
