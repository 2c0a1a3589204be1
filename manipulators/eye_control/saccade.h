#pragma once

#include <cmath>

#include "manipulators/eye_control/parameters.h"

namespace eye {

/// The burst generator: a local feedback loop drives the motor error e to rest with e' = -B r(t) (1 - exp(-e / angle)),
/// r(t) = 1 - (1 + t / rise) exp(-t / rise) being the recruitment of the burst. With s the integral of r, the solution
/// over a step is closed: e1 = angle log(1 + (exp(e0 / angle) - 1) exp(-B (s1 - s0) / angle)). Two equal lags smooth
/// the burst. A matched pulse, slide and step make the eye follow that velocity, so the main sequence is the burst's
/// own. The displacement adds up to the amplitude exactly: nothing is lost at the end.
class Saccade {
 public:
  /// Begin a saccade by `displacement`, rad; the burst starts with the next step.
  void begin(Vec2 displacement, const Parameters& p) {
    const double amplitude = norm(displacement);
    direction_ = (1 / amplitude) * displacement;
    // pause cells wait for a smaller error before the end of a small saccade
    stop_ = p.burst_stop * amplitude / (amplitude + 1 * deg);
    error_ = amplitude + stop_;
    elapsed_ = 0;
    bursting_ = true;
    flying_ = true;
  }

  /// Displacement of the eye over the next step, rad.
  Vec2 advance(const Parameters& p, double h) {
    const double burst = bursting_ ? drive(p, h) : 0;
    const double keep = std::exp(-h / p.burst_lag);
    const double first = burst + (first_ - burst) * keep;
    const double second = burst + (second_ - burst) * keep + (first_ - burst) * (h / p.burst_lag) * keep;
    const double moved = h * burst - p.burst_lag * (first - first_ + second - second_);
    first_ = first;
    second_ = second;
    flying_ = bursting_ || second_ > landed;
    // what is left of the lags is far below anything seen: give it out at once and rest
    if (!bursting_ && first_ + second_ < 1e-6) return (moved + finish(p)) * direction_;
    return moved * direction_;
  }

  /// The eye moves at more than saccadic speed.
  bool flying() const { return flying_; }
  /// Anything is left to be moved.
  bool active() const { return bursting_ || second_ > 0; }
  /// Velocity along the path, rad/s.
  double speed() const { return second_; }

  template <class Visit>
  void each(Visit&& visit) {
    visit(direction_.x), visit(direction_.y), visit(error_), visit(stop_), visit(elapsed_), visit(first_),
        visit(second_);
    visit(bursting_), visit(flying_);
  }

 private:
  static constexpr double landed = 12 * deg;  ///< speed at which a saccade counts as over, rad/s

  // mean burst over the step; the last step gives exactly what is missing
  double drive(const Parameters& p, double h) {
    const double before = elapsed_ / p.burst_rise, after = (elapsed_ + h) / p.burst_rise;
    const double recruited = h + p.burst_rise * ((after + 2) * std::exp(-after) - (before + 2) * std::exp(-before));
    const double next = p.burst_angle * std::log1p(std::expm1(error_ / p.burst_angle) *
                                                   std::exp(-p.burst_speed * recruited / p.burst_angle));
    elapsed_ += h;
    const bool last = next <= stop_;
    const double moved = error_ - (last ? stop_ : next);
    error_ = next;
    bursting_ = !last;
    return moved / h;
  }

  double finish(const Parameters& p) {
    const double left = p.burst_lag * (first_ + second_);
    first_ = second_ = 0;
    return left;
  }

  Vec2 direction_;
  double error_ = 0, stop_ = 0, elapsed_ = 0, first_ = 0, second_ = 0;
  bool bursting_ = false, flying_ = false;
};

/// Time until the target crosses the eye if both keep their velocities, s: -error . slip / |slip|^2 (de Brouwer et al.
/// 2002). Infinite without slip.
inline double eye_crossing_time(Vec2 error, Vec2 slip) {
  const double speed2 = dot(slip, slip);
  return speed2 > 1e-12 ? -dot(error, slip) / speed2 : HUGE_VAL;
}

/// Whether a saccade is called for: the error is seen and pursuit alone will not close it in time.
inline bool wants_saccade(Vec2 error, Vec2 slip, const Parameters& p) {
  if (!(dot(error, error) > p.dead_zone * p.dead_zone)) return false;
  const double crossing = eye_crossing_time(error, slip);
  return !(crossing >= p.smooth_from && crossing <= p.smooth_to);
}

}  // namespace eye
