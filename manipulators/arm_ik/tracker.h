#pragma once

#include <span>

#include "manipulators/arm_ik/solver.h"

namespace arm_ik {

struct TrackOptions {
  double position_tolerance = 1e-5;  ///< [m]
  double rotation_tolerance = 1e-4;  ///< [rad]
  double rate = 10;                  ///< the most that a joint moves [rad/s, m/s]
  double settle = 0.1;               ///< time constant [s] with which null space returns to the posture
  Isa isa = best_isa();
};

/// Follows a moving goal, one small step a tick, without ever starting anew: no branch is left that goes on.
///
/// A tick asks for the step that does what the task asks exactly and is nearest to a pull towards a preferred posture,
/// inside the joint limits and the joint rates (one quadratic program, active set); then corrects what the linear model
/// left. The pull makes closed paths return to their posture. Joints near a limit move less willingly, so that they
/// glide along it. When the task cannot be done in this tick (out of reach, at limits, too fast) the step is the one
/// that brings the tool nearest instead, by projected Levenberg-Marquardt inside the same box. Cost: about 0.8 us for
/// eleven joints.
class Tracker {
 public:
  explicit Tracker(const Packed& chain) : chain_(chain) {}

  /// Moves q (#joints, inside the limits) by one tick of `dt` seconds. `posture` (#joints): what null space returns to.
  /// `status`: reached; limited otherwise (the caller knows more).
  Solution follow(const Goal& goal, const TrackOptions& options, std::span<const double> posture, double dt,
                  std::span<double> q) const;

 private:
  const Packed& chain_;
};

}  // namespace arm_ik
