#include "manipulators/arm_ik/girdle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "manipulators/kinematics/pose.h"

namespace arm_ik {

namespace {

using kinematics::rotation_x;
using kinematics::rotation_y;
using kinematics::rotation_z;

constexpr double degree = std::numbers::pi / 180;

// angle = constant + plane * Hy + elevation * Hz + rest * (angle at rest), degrees
struct Regression {
  double constant, plane, elevation, rest, at_rest;
  double operator()(double hy, double hz) const {
    return (constant + plane * hy + elevation * hz + rest * at_rest) * degree;
  }
};

constexpr Regression clavicle_y = {-4.983, 0.120, -0.242, 0.851, -28.573};
constexpr Regression clavicle_z = {3.917, -0.046, 0.123, 0.493, 11.680};
constexpr Regression scapula_y = {-1.203, 0.140, -0.049, 0.901, 32.047};
constexpr Regression scapula_z = {3.095, -0.079, 0.396, 0.414, 10.669};
constexpr Regression scapula_x = {0.659, -0.028, 0.184, 0.886, -10.320};
constexpr double clavicle_x_at_rest = 7.482;

Eigen::Matrix3d yzx(double y, double z, double x) { return rotation_y(y) * rotation_z(z) * rotation_x(x); }

// the acromioclavicular rotation at rest
Eigen::Matrix3d joint_at_rest() {
  const Eigen::Matrix3d clavicle =
      yzx(clavicle_y.at_rest * degree, clavicle_z.at_rest * degree, clavicle_x_at_rest * degree);
  const Eigen::Matrix3d scapula =
      yzx(scapula_y.at_rest * degree, scapula_z.at_rest * degree, scapula_x.at_rest * degree);
  return clavicle.transpose() * scapula;
}

}  // namespace

GirdleAngles rhythm(double plane, double elevation) {
  static const Eigen::Matrix3d at_rest = joint_at_rest();
  const double hy = plane / degree, hz = elevation / degree;
  const double cy = clavicle_y(hy, hz), cz = clavicle_z(hy, hz);
  const Eigen::Matrix3d axis = rotation_y(cy) * rotation_z(cz);
  const Eigen::Matrix3d scapula = yzx(scapula_y(hy, hz), scapula_z(hy, hz), scapula_x(hy, hz));
  // the x turn that brings clavicle^T scapula nearest to its rest maximizes trace(Rx(-turn) B)
  const Eigen::Matrix3d B = axis.transpose() * scapula * at_rest.transpose();
  const double turn = std::atan2(B(2, 1) - B(1, 2), B(1, 1) + B(2, 2));
  const Eigen::Matrix3d joint = rotation_x(-turn) * axis.transpose() * scapula;
  return {cy,
          cz,
          turn,
          std::atan2(-joint(2, 0), joint(0, 0)),
          std::asin(std::clamp(joint(1, 0), -1.0, 1.0)),
          std::atan2(-joint(1, 2), joint(1, 1))};
}

Eigen::Matrix3d scapula_of(const GirdleAngles& a) { return yzx(a[0], a[1], a[2]) * yzx(a[3], a[4], a[5]); }

double scapular_share() { return scapula_z.elevation; }

}  // namespace arm_ik
