#pragma once

#include <algorithm>
#include <cmath>

#include "manipulators/eye_control/lag.h"
#include "manipulators/eye_control/memory.h"
#include "manipulators/eye_control/parameters.h"

namespace eye {

/// Vergence: after its own latency the disparity is closed by a slow component (speed proportional to disparity,
/// limited), by a fast component when the disparity is large (a planned burst that ends when a tenth of the plan is
/// left), and faster still while a saccade is in flight. The reference is reconstructed with an efference copy, as in
/// pursuit: with copy gain 1 no delay is left in the loop, with 0 it is the plain delayed feedback that rings above
/// gain pi / (2 latency).
template <int W>
class Vergence {
 public:
  /// Moments hold the disparity with a delay of `already` steps.
  Vergence(const Parameters& p, int already)
      : k_{p.step,
           p.vergence_rate,
           p.vergence_limit,
           p.vergence_step,
           p.vergence_burst_speed,
           p.vergence_burst_angle,
           p.convergence_saccade_rate,
           p.divergence_saccade_rate,
           p.vergence_copy_gain,
           p.steps(p.vergence_latency),
           std::max(0, p.steps(p.vergence_latency) - already),
           Lag(p.plant_time, p.step)} {}

  /// How far back the step looks, steps: with a whole copy the eyes' own past is not asked for.
  int span() const { return k_.copy_gain == 1 ? k_.seen : k_.latency; }

  /// Vergence at n + 1, rad, into `next`; `in_saccade` is 0 or 1.
  EYE_INLINE void advance(const Memory<W>& memory, int64_t n, const Lanes<W>& in_saccade, Moment<W>& next);

  void rest(size_t i, double vergence) {
    s_.command[i] = vergence;
    s_.rate[i] = s_.burst[i] = s_.planned[i] = 0;
  }

  /// rad/s
  double rate(size_t i) const { return s_.rate[i]; }

  template <class Visit>
  void each(size_t i, Visit&& visit) {
    visit(s_.command[i]), visit(s_.rate[i]), visit(s_.burst[i]), visit(s_.planned[i]);
  }

 private:
  static constexpr size_t width = W;

  struct Constants {
    double step, slow, limit, least, burst_speed, burst_angle, converging, diverging, copy_gain;
    int latency, seen;
    Lag muscle;
  };
  struct State {
    Lanes<W> command{}, rate{}, burst{}, planned{};
  };

  // speed of the fast component of one lane over the step, rad/s; it is planned when it starts and runs down by itself,
  // whatever is seen meanwhile
  static double burst_speed(const Constants& k, double& burst, double planned) {
    const double speed = k.burst_speed * -std::expm1(-std::abs(burst) / k.burst_angle);
    burst -= std::copysign(speed * k.step, burst);
    if (burst * planned < 0.1 * planned * planned) burst = 0;
    return speed;
  }

  Constants k_;
  State s_;
};

template <int W>
void Vergence<W>::advance(const Memory<W>& memory, int64_t n, const Lanes<W>& in_saccade, Moment<W>& next) {
  const Constants k = k_;
  State s = s_;
  const Lanes<W>&seen = memory[n - k.seen].disparity, &now = memory[n].vergence;
  Lanes<W> error, fast{};
  for (size_t i = 0; i < width; ++i) error[i] = seen[i] - k.copy_gain * s.command[i];
  if (k.copy_gain != 1) {
    const Lanes<W>& then = memory[n - k.latency].vergence;
    for (size_t i = 0; i < width; ++i) error[i] -= (1 - k.copy_gain) * then[i];
  }

  double bursts = 0;
  for (size_t i = 0; i < width; ++i) {
    const double kept = s.burst[i] * error[i] <= 0 ? 0 : s.burst[i];
    const bool starts = kept == 0 && std::abs(error[i]) > k.least;
    s.burst[i] = starts ? error[i] : kept;
    s.planned[i] = starts ? error[i] : s.planned[i];
    bursts += std::abs(s.burst[i]);
  }
  if (bursts != 0) {
    for (size_t i = 0; i < width; ++i) {
      if (s.burst[i] != 0) fast[i] = burst_speed(k, s.burst[i], s.planned[i]);
    }
  }

  for (size_t i = 0; i < width; ++i) {
    const double size = std::abs(error[i]), slow = k.slow * size;
    const double alone = (slow < k.limit ? slow : k.limit) + fast[i];
    const double flying = size * (error[i] > 0 ? k.converging : k.diverging);
    const double helped = alone < flying ? flying : alone;
    const double wanted = k.step * (in_saccade[i] != 0 ? helped : alone);
    // with a copy nothing is closed twice
    const double most = k.copy_gain > 0 ? size : HUGE_VAL;
    const double closed = std::copysign(wanted < most ? wanted : most, error[i]);
    s.command[i] += closed;

    // the muscles lag behind the command; the displacement of a lag is known exactly
    const double rate = settled(k.muscle.advance(s.rate[i], closed / k.step, closed / k.step));
    next.vergence[i] = now[i] + (closed - k.muscle.time * (rate - s.rate[i]));
    s.rate[i] = rate;
  }
  s_ = s;
}

}  // namespace eye
