#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "manipulators/eye_control/lag.h"
#include "manipulators/eye_control/memory.h"
#include "manipulators/eye_control/parameters.h"
#include "manipulators/eye_control/predictor.h"

namespace eye {

/// Smooth pursuit: the delayed, saturating loop with an efference copy of the motor command.
///
///     slip(t) = target velocity - eye velocity            seen after visual_delay (and visual_lag)
///     That    = slip(t - tv) + g w(t - tv')               reconstructed target velocity
///     u       = P VS(That), blended with the forecast     VS: clamp of the speed
///     c'      = AS(K (u - c(t - tm)))                     AS(x) = x / (1 + |x| / limit), the premotor loop
///     v'      = (c(t - to) - v) / T2                      the eye after the matched pulse-step
///     w'      = (c(t - to') - w) / T2'                    the brain's copy of v
///
/// Every delay is at least one step, so over a step all delayed terms are known: c is a pure quadrature (trapezoid,
/// with one-sided limits at the ends of the step) and v, w are exponentials with linear forcing (exact). Second order,
/// no stability limit from the saturations, no iteration.
class Pursuit {
 public:
  explicit Pursuit(const Parameters& p);

  /// How far back the step looks, steps.
  int span() const { return span_; }
  int visual_steps() const { return visual_; }

  /// One step from n to n + 1. `target` is the mean target velocity over the step as it was visual_steps ago (head
  /// frame, rad/s), `noise` is added to what is seen, `error` is the position error seen (rad): as far as the forecast
  /// is trusted, it is closed at `position_rate`, since an eye that keeps up would else keep its distance too. Writes
  /// command, velocity and copy of moment n + 1; returns the displacement of the eye, rad.
  Vec2 advance(Memory& memory, int64_t n, Vec2 target, Vec2 noise, Vec2 error, bool visible);

  /// Reconstructed target velocity at the end of the last step, rad/s.
  Vec2 target_velocity() const { return seen_; }
  /// It is fast enough to be pursued.
  bool target_moves() const { return dot(seen_, seen_) > p_->pursuit_on * p_->pursuit_on; }
  /// Retinal slip at the start of the last step (visual_steps ago), rad/s.
  Vec2 slip() const { return slip_; }
  /// Pursuit is switched on.
  bool active() const { return active_; }
  /// Trust in the forecast of each component.
  Vec2 trust() const { return {horizontal_.trust(), vertical_.trust()}; }

  template <class Visit>
  void each(Visit&& visit) {
    visit(seen_.x), visit(seen_.y), visit(slip_.x), visit(slip_.y), visit(held_.x), visit(held_.y);
    visit(active_), visit(head_speed_), visit(still_), visit(unseen_);
    horizontal_.each(visit), vertical_.each(visit);
  }

 private:
  void switch_over(double head_speed);
  Vec2 saturated(Vec2 error) const;
  Vec2 drive(Vec2 seen, Vec2 error, double ahead) const;

  const Parameters* p_;
  double h_;
  int visual_, copy_visual_, local_, motor_, copy_motor_, span_;
  int hold_, blank_;
  bool linear_, switched_, predicting_;
  Lag plant_, copy_plant_, sight_;
  double fade_, forget_;
  Predictor horizontal_, vertical_;

  Vec2 seen_, slip_, held_;
  bool active_ = false;
  double head_speed_ = 0;
  int still_ = 0, unseen_ = 0;
};

}  // namespace eye
