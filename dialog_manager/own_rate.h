#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace manager {

/// The ticks of a program that wants fewer than the manager gives: `hertz`, 0 for every one.
struct OwnRate {
  double hertz = 0;

  /// Is it to take part in this tick, of so many a second?
  bool due(std::uint64_t tick, double manager_hertz) const {
    if (hertz <= 0 || hertz >= manager_hertz) return true;
    const double ratio = hertz / manager_hertz;
    // the ticks at which the count of its own, rounded down, grows
    constexpr double rounding = 1e-9;
    return std::floor(static_cast<double>(tick) * ratio + rounding) >
           std::floor(static_cast<double>(tick - 1) * ratio + rounding);
  }

  /// The time (s) that its tick covers, when the last one that it was told was `last` (0 for none).
  double step(std::uint64_t tick, std::uint64_t last, double manager_step) const {
    if (last != 0) return static_cast<double>(tick - last) * manager_step;
    return hertz > 0 ? std::max(manager_step, 1 / hertz) : manager_step;
  }
};

}  // namespace manager
