#pragma once

#include <algorithm>
#include <cstdint>

namespace manager {

/// When a program is to write down its state, and whether it lives through that.
class CheckpointPlan {
 public:
  /// It was told this tick.
  void ticked(std::uint64_t tick) {
    if (first_ == 0) first_ = tick;
    last_ = tick;
  }
  /// The last tick that it was told, 0 for none.
  std::uint64_t last_tick() const { return last_; }
  /// Ticks since its state was written down.
  std::uint64_t since() const { return last_ - std::max(first_ - 1, tick_); }

  void want() { wanted_ = true; }
  bool wanted() const { return wanted_; }
  void asked() { wanted_ = false; }
  /// It answered, and what it wrote is taken as of the last tick.
  void answered() { lost_ = 0; }
  void written() { tick_ = last_; }
  /// The tick after which the last one was written, 0 for none.
  std::uint64_t tick() const { return tick_; }

  /// It died of it. True: that was once too often, it is asked no longer.
  bool died() { return ++lost_ >= allowed; }
  bool given_up() const { return lost_ >= allowed; }

 private:
  static constexpr int allowed = 2;
  std::uint64_t first_ = 0, last_ = 0, tick_ = 0;
  bool wanted_ = false;
  int lost_ = 0;  // in a row, lives that ended in one
};

}  // namespace manager
