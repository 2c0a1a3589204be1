#include "dialog_manager/clock.h"

#include <algorithm>
#include <cmath>

namespace manager {

double Clock::time_of(std::uint64_t tick) const {
  return base_time_ + (static_cast<double>(tick) - static_cast<double>(base_tick_)) / rate_;
}

std::uint64_t Clock::ticks_until(double time) const {
  const double ticks = (time - this->time()) * rate_;
  return static_cast<std::uint64_t>(std::max(0.0, std::ceil(ticks - 1e-6)));
}

void Clock::set_rate(double hertz) {
  base_time_ = time();
  base_tick_ = tick_;
  rate_ = hertz;
  wake();
}

void Clock::set(std::uint64_t tick, double time) {
  tick_ = base_tick_ = tick;
  base_time_ = time;
  wake();
}

void Clock::set_pace(double pace) {
  pace_ = pace;
  wake();
}

void Clock::wake() {
  paced_since_ = Wall::now();
  paced_tick_ = tick_;
}

std::optional<Clock::Wall::time_point> Clock::next_tick_due() const {
  if (pace_ <= 0) return std::nullopt;
  const double seconds = static_cast<double>(tick_ + 1 - paced_tick_) / rate_ / pace_;
  return paced_since_ + std::chrono::duration_cast<Wall::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace manager
