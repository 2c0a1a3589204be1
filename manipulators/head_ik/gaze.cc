#include "manipulators/head_ik/gaze.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace head {
namespace {

constexpr double degree = M_PI / 180;

// 1 below `from`, 0 above `to`, with level ends
double fade(double x, double from, double to) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

double part(double angle, double slope, const Share& share) {
  const double size = std::abs(angle);
  return std::copysign(std::max({0.0, slope * (size - share.start), size - share.reach}), angle);
}

}  // namespace

Gaze gaze(const Eigen::Vector3d& d) {
  const double across = std::hypot(d.x(), d.z());
  return {across == 0 ? 0 : std::atan2(d.x(), d.z()), std::atan2(d.y(), across)};
}

Eigen::Vector3d direction(const Gaze& g) {
  return {std::cos(g.pitch) * std::sin(g.yaw), std::sin(g.pitch), std::cos(g.pitch) * std::cos(g.yaw)};
}

Eigen::Matrix3d donders(const Gaze& g, double roll) {
  using Eigen::Quaterniond;
  const double cy = std::cos(g.yaw / 2), sy = std::sin(g.yaw / 2);
  const double cp = std::cos(g.pitch / 2), sp = -std::sin(g.pitch / 2);
  const Quaterniond fick = Quaterniond(cy, 0, sy, 0) * Quaterniond(cp, sp, 0, 0);
  // fick = listing * Rz(torsion), where z and w of fick carry the torsion
  const double torsion = 2 * std::atan2(fick.z(), fick.w());
  const double unwound = -(1 - roll * fade(std::abs(g.pitch), 60 * degree, 85 * degree)) * torsion;
  return (fick * Quaterniond(std::cos(unwound / 2), 0, 0, std::sin(unwound / 2))).toRotationMatrix();
}

Eigen::Matrix3d facing(const Eigen::Vector3d& normal, double roll) { return donders(gaze(-normal), roll); }

Gaze head_part(const Gaze& g, const Share& share) {
  return {part(g.yaw, share.yaw, share) * fade(std::abs(g.pitch), 60 * degree, 90 * degree),
          part(g.pitch, share.pitch, share)};
}

double head_lag(double amplitude) { return std::clamp(0.139 - 0.003 * (amplitude / degree - 10), 0.0, 0.140); }

}  // namespace head
