#pragma once

#include <Eigen/Geometry>

namespace head {

/// A rotation as a swing and a twist: R = exp(swing about an axis in the X-Z plane) * exp(twist about Y). For a head:
/// how the neck leans, then how the face turns on it. Undefined only where Y points down (swing = pi).
struct SwingTwist {
  double x = 0, z = 0;  ///< rotation vector of the swing [rad]
  double twist = 0;     ///< about Y, in (-pi, pi] [rad]
};

Eigen::Quaterniond quaternion(const SwingTwist& angles);

/// Where the swing is pi its axis is free; the twist is then 0.
SwingTwist swing_twist(const Eigen::Quaterniond& q);

}  // namespace head
