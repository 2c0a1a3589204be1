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
class Vergence {
 public:
  explicit Vergence(const Parameters& p)
      : p_(&p), h_(p.step), latency_(p.steps(p.vergence_latency)), muscle_(p.plant_time, p.step) {}

  int span() const { return latency_; }

  /// Vergence at n + 1, rad. Moments hold the disparity with a delay of `already` steps.
  double advance(const Memory& memory, int64_t n, int already, bool in_saccade) {
    const double seen = memory[n - std::max(0, latency_ - already)].disparity;
    const double error =
        seen - p_->vergence_copy_gain * command_ - (1 - p_->vergence_copy_gain) * memory[n - latency_].vergence;
    const double closed = change(error, in_saccade);
    command_ += closed;

    // the muscles lag behind the command; the displacement of a lag is known exactly
    const double rate = muscle_.advance(rate_, closed / h_, closed / h_);
    const double moved = closed - muscle_.time * (rate - rate_);
    rate_ = rate;
    return memory[n].vergence + moved;
  }

  void rest(double vergence) {
    command_ = vergence;
    rate_ = burst_ = planned_ = 0;
  }

  /// rad/s
  double rate() const { return rate_; }

  template <class Visit>
  void each(Visit&& visit) {
    visit(command_), visit(rate_), visit(burst_), visit(planned_);
  }

 private:
  // change of the command over one step
  double change(double error, bool in_saccade) {
    const double size = std::abs(error);
    double speed = std::min(p_->vergence_rate * size, p_->vergence_limit);

    // the fast component is planned when it starts and runs down by itself, whatever is seen meanwhile
    if (burst_ * error <= 0) burst_ = 0;
    if (burst_ == 0 && size > p_->vergence_step) burst_ = planned_ = error;
    if (burst_ != 0) {
      const double burst_speed = p_->vergence_burst_speed * -std::expm1(-std::abs(burst_) / p_->vergence_burst_angle);
      speed += burst_speed;
      burst_ -= std::copysign(burst_speed * h_, burst_);
      if (burst_ * planned_ < 0.1 * planned_ * planned_) burst_ = 0;
    }
    if (in_saccade) {
      speed = std::max(speed, size * (error > 0 ? p_->convergence_saccade_rate : p_->divergence_saccade_rate));
    }
    return std::copysign(std::min(speed * h_, p_->vergence_copy_gain > 0 ? size : HUGE_VAL), error);
  }

  const Parameters* p_;
  double h_;
  int latency_;
  Lag muscle_;
  double command_ = 0, rate_ = 0, burst_ = 0, planned_ = 0;
};

}  // namespace eye
