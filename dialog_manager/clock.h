#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace manager {

/// Simulated time: ticks of equal length, counted. The time of a tick is computed from its number, never summed.
class Clock {
 public:
  using Wall = std::chrono::steady_clock;

  double rate() const { return rate_; }  ///< ticks a second
  double step() const { return 1 / rate_; }
  std::uint64_t tick() const { return tick_; }
  double time() const { return time_of(tick_); }
  double time_of(std::uint64_t tick) const;
  /// Ticks until a time is reached; a time within rounding of a tick is that tick.
  std::uint64_t ticks_until(double time) const;

  /// From now on; the time reached so far stays.
  void set_rate(double hertz);
  void advance() { ++tick_; }
  /// For a world that is taken up again.
  void set(std::uint64_t tick, double time);

  /// Simulated seconds a second of the wall; 0: as fast as it goes.
  double pace() const { return pace_; }
  void set_pace(double pace);
  /// When the wall clock wants the next tick; nothing when it is to come at once.
  std::optional<Wall::time_point> next_tick_due() const;
  /// Time begins to flow after a rest: what was missed is not made up.
  void wake();

 private:
  double rate_ = 60;
  std::uint64_t tick_ = 0;
  std::uint64_t base_tick_ = 0;
  double base_time_ = 0;
  double pace_ = 0;
  Wall::time_point paced_since_{};
  std::uint64_t paced_tick_ = 0;
};

}  // namespace manager
