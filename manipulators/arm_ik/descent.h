#pragma once

#include <Eigen/Core>

#include "manipulators/arm_ik/lanes.h"
#include "manipulators/arm_ik/packed.h"

namespace arm_ik {

/// What a solver is asked for: a place, and an orientation when `pose`.
struct Goal {
  /// Beyond this [m] in any coordinate the place is cut: squares of larger numbers leave the doubles' range.
  static constexpr double farthest = 1e9;

  Goal(const kinematics::Pose& X, bool with_orientation);
  kinematics::Pose target() const;

  alignas(32) double frame[16];  ///< columns x y z p, four numbers each
  bool pose;
};

struct DescentOptions {
  double position_tolerance = 1e-5;  ///< [m]
  double rotation_tolerance = 1e-4;  ///< [rad]
  int iterations = 50;
  double patience = 1;       ///< gives up when two steps in a row leave more than this share of the squared error
  double standstill = 1e-9;  ///< a step that lowers the squared error by a smaller share is the last
  double damping = 0.05;     ///< first damping, as a share of the squared error
  /// The goal is out of reach: steps follow the true slope of the squared error. A turn's chord pulls harder than that
  /// by 1 / cos(angle / 2), which is quicker on the way to a goal and wrong where the error stays.
  bool far = false;
  /// Bounds of q (#joints, padded to fours) inside the chain's limits; null: the limits.
  const double* lower = nullptr;
  const double* upper = nullptr;
};

struct DescentResult {
  bool reached = false;
  bool stationary = false;  ///< no step within the limits lowers the error any more
  int iterations = 0;
  double position_error = 0;  ///< [m]
  double rotation_error = 0;  ///< [rad]; of a place: 0
  double cost = 0;            ///< squared error [m^2], a radian weighing chain.length
};

/// The angle [rad] of a turn from its chord 2 sin(angle / 2).
double angle_of_chord(double chord);

/// Projected Levenberg-Marquardt from q (#joints, brought inside the limits; overwritten by the best posture found).
/// Every step solves min |J dq - e|^2 + damping |dq|^2 with the joints that would pass a limit held at it, one round
/// for each new one (active set). The damping is proportional to the squared error, which keeps convergence quadratic
/// at singular postures too. A step that does not lower the error is taken back and damped more. Cost: about 0.2 us a
/// step for eleven joints. The same bits for every `isa`.
DescentResult descend(const Packed& chain, const Goal& goal, const DescentOptions& options, double* q, Isa isa);

}  // namespace arm_ik
