#pragma once

#include <Eigen/Core>
#include <string_view>

namespace head {

/// An orientation as the head control unit of the Virtual Sailor reports it: R = Rz(alpha) Ry(beta) Rz(gamma), turns
/// about current axes [rad]. Z is the look axis, so beta is how far the gaze is from straight ahead, alpha in which
/// direction (0 = left, pi/2 = up for a person facing +Z), gamma + alpha the roll when beta is small.
/// -pi <= alpha, gamma <= pi and 0 <= beta <= pi.
struct Zyz {
  double alpha = 0, beta = 0, gamma = 0;
};

Eigen::Matrix3d rotation(const Zyz& angles);

/// The angles of R, exact to rounding for every beta: alpha from the look axis, then gamma from what alpha leaves, so
/// an arbitrary alpha near the poles is made good by gamma. On a pole alpha = 0. Noise e in the entries of R comes back
/// as a rotation error of the size of e, nowhere amplified.
Zyz zyz(const Eigen::Matrix3d& R);

/// Other ways to find the same angles, kept to show where they fail.
enum class ZyzRule {
  two_step,    ///< `zyz` above
  half_angle,  ///< half sum and half difference of alpha and gamma from the quaternion
  arc_cosine,  ///< beta = acos(r33): loses half of the digits near the poles
  not_both,    ///< the paper with its condition corrected: poles only at exactly sin(beta) = 0, beta = pi missing
  paper        ///< the paper as printed: "both r31 and r32 are not zero"
};

Zyz zyz(const Eigen::Matrix3d& R, ZyzRule rule);

std::string_view name_of(ZyzRule rule);

}  // namespace head
