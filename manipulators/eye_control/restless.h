#pragma once

#include <cstdint>

#include "manipulators/eye_control/parameters.h"

namespace eye {

/// What never rests, all of it off by default and a pure function of seed and step: fixation drift, the moments of
/// microsaccades, blinks.
class Restless {
 public:
  /// `seed` of this pair of eyes: `Parameters::seed` is not looked at.
  Restless(const Parameters& p, uint64_t seed);

  /// Drift over the step n, rad: a velocity with memory `drift_time` and root mean square `drift_speed` per component.
  Vec2 drift(int64_t n);

  /// Whether a microsaccade starts with step n, and by how much: back towards the target, size spread around
  /// `microsaccade_size` and below one degree.
  bool microsaccade(int64_t n, Vec2 error, Vec2& displacement) const;

  /// Lid closure at the end of step n, 0 open to `blink_depth`.
  double lid(int64_t n);
  bool blinking() const { return blink_from_ >= 0; }
  /// `lid` has anything to do.
  bool blinks() const { return p_->blink_rate > 0 || blinking(); }

  template <class Visit>
  void each(Visit&& visit) {
    visit(drift_.x), visit(drift_.y), visit(blink_from_), visit(quiet_until_);
  }

 private:
  const Parameters* p_;
  double h_;
  uint64_t seed_;
  Vec2 drift_;
  int64_t blink_from_ = -1, quiet_until_ = 0;
};

}  // namespace eye
