#include "manipulators/head_ik/swing_twist.h"

#include <cmath>

namespace head {

Eigen::Quaterniond quaternion(const SwingTwist& angles) {
  const double swing = std::hypot(angles.x, angles.z);
  // sin(swing / 2) / swing, whose limit at rest is 1/2
  const double scale = swing > 1e-8 ? std::sin(swing / 2) / swing : 0.5;
  const Eigen::Quaterniond s(std::cos(swing / 2), scale * angles.x, 0, scale * angles.z);
  return s * Eigen::Quaterniond(std::cos(angles.twist / 2), 0, std::sin(angles.twist / 2), 0);
}

SwingTwist swing_twist(const Eigen::Quaterniond& q) {
  const double along = std::sqrt(q.w() * q.w() + q.y() * q.y());
  if (along == 0) return {M_PI * q.x(), M_PI * q.z(), 0};
  // the twist's own quaternion is (w, 0, y, 0) normalized, the swing's is q times its inverse
  const double c = q.w() / along, s = q.y() / along;
  const double x = c * q.x() + s * q.z(), z = c * q.z() - s * q.x();
  const double across = std::sqrt(x * x + z * z), swing = 2 * std::atan2(across, along);
  const double scale = across > 1e-8 ? swing / across : 2;
  return {scale * x, scale * z, std::remainder(2 * std::atan2(s, c), 2 * M_PI)};
}

}  // namespace head
