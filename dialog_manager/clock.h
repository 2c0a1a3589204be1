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
  /// The tick and time that all times are computed from: those of the last change of the rate.
  std::uint64_t base_tick() const { return base_tick_; }
  double base_time() const { return base_time_; }
  /// After set(): computes from an earlier tick, so that times have the bits that they had.
  void compute_from(std::uint64_t base_tick, double base_time) {
    base_tick_ = base_tick;
    base_time_ = base_time;
  }

  /// Simulated seconds a second of the wall; 0: as fast as it goes.
  double pace() const { return pace_; }
  void set_pace(double pace);
  /// Slower or faster than this is no pace: the time of a tick could not be counted.
  static bool is_pace(double pace) { return pace >= 1e-6 && pace <= 1e6; }
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
