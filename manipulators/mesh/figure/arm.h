#pragma once

#include <Eigen/Geometry>
#include <array>

#include "manipulators/mesh/figure/axes.h"

namespace figure {

/// The right arm of the Dutch shoulder and elbow model: eleven joints from the thorax to the wrist, as a
/// Denavit-Hartenberg table whose lengths are scaled segment by segment (the angles between the axes stay).
/// Its thorax frame is x right, y up, z back; all frames here are in it.
struct Arm {
  static constexpr int joints = 11;
  enum Joint { sc_y, sc_z, sc_x, ac_y, ac_z, ac_x, gh_y, gh_z, gh_yy, el_x, ps_y };

  std::array<const char*, joints> names;
  std::array<Dh, joints> rows;
  std::array<double, joints> lower, upper, rest;  ///< rad
  Eigen::Isometry3d base, tool;

  /// Frames before each joint (its z is the joint's axis), then the wrist: joints + 1 of them.
  std::array<Eigen::Isometry3d, joints + 1> frames(const std::array<double, joints>& q) const;
};

/// `girdle` scales collarbone and shoulder blade, `humerus` the length of the upper arm, `forearm` that of the forearm;
/// the small offsets at the elbow go with the mean of the last two.
Arm scaled_arm(double girdle, double humerus, double forearm);

/// The six girdle angles (SC y z x, AC y z x) that go with a humerus in plane `plane` (0 sideways, positive forward)
/// raised by `elevation`, rad: regression of de Groot and Brand 2001 with the least rotation in the acromioclavicular
/// joint. Clamped to the arm's limits.
std::array<double, 6> girdle_rhythm(const Arm& arm, double plane, double elevation);

}  // namespace figure
