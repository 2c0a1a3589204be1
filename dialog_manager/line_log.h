#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

namespace manager {

/// The accepted lines that changed the world, the latest of them, by number: what `why` tells. One ring of bytes, so
/// that a flood of lines costs a copy each and no memory.
class LineLog {
 public:
  /// The number of this line; numbers start at 1.
  std::uint64_t add(std::string_view text) {
    if (places_.empty()) {
      places_.resize(kept);
      bytes_.resize(room);
    }
    // a line stands in one piece
    if (room - end_ % room < text.size()) end_ += room - end_ % room;
    std::memcpy(bytes_.data() + end_ % room, text.data(), text.size());
    places_[next_ % kept] = {end_, text.size()};
    end_ += text.size();
    return next_++;
  }
  /// Nothing when it is no longer kept.
  std::optional<std::string_view> find(std::uint64_t number) const {
    if (number == 0 || number >= next_ || next_ - number > kept) return std::nullopt;
    const Place& place = places_[number % kept];
    if (end_ - place.start > room) return std::nullopt;
    return std::string_view(bytes_.data() + place.start % room, place.size);
  }

 private:
  struct Place {
    std::uint64_t start = 0;  // bytes before it, ever
    std::size_t size = 0;
  };
  static constexpr std::size_t kept = 1 << 16, room = 4 << 20;
  std::vector<Place> places_;
  std::vector<char> bytes_;
  std::uint64_t end_ = 0;
  std::uint64_t next_ = 1;
};

}  // namespace manager
