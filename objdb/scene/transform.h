#pragma once

#include "objdb/value.h"

namespace objdb::scene {

/// A rigid transform X_AB: p_A = R p_B + p. Plain loops in a fixed order, so that every build gives the same bits.
struct Transform {
  std::array<std::array<double, 3>, 3> R{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows
  Vec3 p{0, 0, 0};                                                            ///< metres
};

/// X_AC from X_AB and X_BC.
Transform operator*(const Transform& a, const Transform& b);
/// p_A of a point p_B.
Vec3 operator*(const Transform& x, const Vec3& point);
/// X_BA from X_AB.
Transform inverse(const Transform& x);

/// From a place and a rotation w x y z, which need not be of unit length but must not be 0.
Transform from_pose(const Vec3& position, const Quat& orientation);
/// Rotation as a unit quaternion w x y z with w >= 0; exact to rounding for every angle (Shepperd 1978).
Quat quaternion(const Transform& x);

/// Standard Denavit-Hartenberg step Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha) (Paul 1981).
Transform denavit_hartenberg(double theta, double d, double a, double alpha);

}  // namespace objdb::scene
