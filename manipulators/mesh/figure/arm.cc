#include "manipulators/mesh/figure/arm.h"

#include <algorithm>
#include <cmath>

namespace figure {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

struct Row {
  const char* name;
  double theta0, d, a, alpha, lower, upper, rest;  // degrees and metres
};

// Denavit-Hartenberg rows computed from the axis lines of DAS3 (Chadwick, Blana and van den Bogert); limits are DAS3's,
// gh_y and gh_yy narrowed to a human box
constexpr Row rows[Arm::joints] = {
    {"sc_y", 0, 0, 0, 90, -65, -19, -33.486},
    {"sc_z", 90, 0, 0, 90, 5, 30, 5.002},
    {"sc_x", 90, 0.2077, 0.0282, 90, 0, 83, 32.914},
    {"ac_y", 90, -0.0001, 0, 90, 33, 69, 45.571},
    {"ac_z", 90, 0, 0, 90, -21.9, 20, 0.458},
    {"ac_x", -90, 0.0020, 0.0439, -90, -17, 18, -12.062},
    {"gh_y", -90, -0.0230, 0, 90, -90, 100, 43.864},
    {"gh_z", 180, 0, 0, 90, -30, 84, -0.218},
    {"gh_yy", 90, -0.291128, 0.0049, -85.7834, -130, 90, -34.659},
    {"el_x", 177.4182, 0.014163, 0.007135, -93.7994, 5, 140, 5},
    {"ps_y", 0, 0, 0, 0, 5, 160, 5},
};

Matrix3d about(double angle, const Vector3d& axis) { return AngleAxisd(angle, axis).toRotationMatrix(); }

Matrix3d yzx(double y, double z, double x) {
  return about(y, Vector3d::UnitY()) * about(z, Vector3d::UnitZ()) * about(x, Vector3d::UnitX());
}

Vector3d yzx_angles(const Matrix3d& R) {
  return {std::atan2(-R(2, 0), R(0, 0)), std::asin(std::clamp(R(1, 0), -1.0, 1.0)), std::atan2(-R(1, 2), R(1, 1))};
}

}  // namespace

std::array<Isometry3d, Arm::joints + 1> Arm::frames(const std::array<double, joints>& q) const {
  std::array<Isometry3d, joints + 1> result;
  Isometry3d X = base;
  for (int i = 0; i < joints; ++i) {
    result[i] = X;
    X = X * rows[i].transform(q[i]);
  }
  // cppcheck-suppress containerOutOfBounds ; it has joints + 1 elements
  result[joints] = X * tool;
  return result;
}

Arm scaled_arm(double girdle, double humerus, double forearm) {
  const double elbow = 0.5 * (humerus + forearm);
  const double d_scale[Arm::joints] = {1, 1, girdle, girdle, 1, girdle, girdle, 1, humerus, elbow, 1};
  const double a_scale[Arm::joints] = {1, 1, girdle, 1, 1, girdle, 1, 1, elbow, elbow, 1};
  Arm arm;
  for (int i = 0; i < Arm::joints; ++i) {
    const Row& row = rows[i];
    arm.names[i] = row.name;
    arm.rows[i] = {row.theta0 * degree, row.d * d_scale[i], row.a * a_scale[i], row.alpha * degree};
    arm.lower[i] = row.lower * degree;
    arm.upper[i] = row.upper * degree;
    arm.rest[i] = row.rest * degree;
  }
  Matrix3d R;
  R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  arm.base = Isometry3d::Identity();
  arm.base.linear() = R;
  arm.base.translation() = girdle * Vector3d(0.0014, -0.0152, 0.0028);
  // the table has six decimals: the nearest rotation keeps the wrist rigid to rounding
  R << -0.011126, -0.043649, -0.998985, -0.983236, 0.182315, 0.002985, 0.182000, 0.982271, -0.044946;
  arm.tool = Isometry3d::Identity();
  arm.tool.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  arm.tool.translation() = forearm * Vector3d(0.001403, -0.009929, -0.243587);
  return arm;
}

std::array<double, 6> girdle_rhythm(const Arm& arm, double plane, double elevation) {
  const double Hy = plane / degree;
  const double Hz = elevation / degree;
  const Vector3d C0(-28.573, 11.680, 7.482);
  const Vector3d S0(32.047, 10.669, -10.320);
  const double Cy = -4.983 + 0.120 * Hy - 0.242 * Hz + 0.851 * C0[0];
  const double Cz = 3.917 - 0.046 * Hy + 0.123 * Hz + 0.493 * C0[1];
  const double Sy = -1.203 + 0.140 * Hy - 0.049 * Hz + 0.901 * S0[0];
  const double Sz = 3.095 - 0.079 * Hy + 0.396 * Hz + 0.414 * S0[1];
  const double Sx = 0.659 - 0.028 * Hy + 0.184 * Hz + 0.886 * S0[2];

  // axial rotation of the collarbone that leaves the shoulder blade as it stood on it at rest, as nearly as possible
  const auto turned = [](const Vector3d& degrees) {
    return yzx(degrees[0] * degree, degrees[1] * degree, degrees[2] * degree);
  };
  const Matrix3d rest = turned(C0).transpose() * turned(S0);
  const Matrix3d scapula = turned({Sy, Sz, Sx});
  const Matrix3d B = turned({Cy, Cz, 0}).transpose() * scapula * rest.transpose();
  const double axial = std::atan2(B(2, 1) - B(1, 2), B(1, 1) + B(2, 2));
  const Matrix3d clavicle = turned({Cy, Cz, axial / degree});
  const Vector3d ac = yzx_angles(clavicle.transpose() * scapula);

  std::array<double, 6> q = {Cy * degree, Cz * degree, axial, ac[0], ac[1], ac[2]};
  for (int i = 0; i < 6; ++i) {
    q[i] = std::clamp(q[i], arm.lower[i], arm.upper[i]);
  }
  return q;
}

}  // namespace figure
