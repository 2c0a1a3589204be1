#include "manipulators/face_fem/face_chart.h"

#include <algorithm>
#include <cmath>

namespace face {

Eigen::Vector3d FaceChart::origin(double height) const { return {x, std::clamp(height, lower, upper), z}; }

Eigen::Vector3d FaceChart::direction(double angle, double height) const {
  const double tilt = (height - std::clamp(height, lower, upper)) / nominal;
  return {std::sin(angle) * std::cos(tilt), std::sin(tilt), std::cos(angle) * std::cos(tilt)};
}

Eigen::Vector3d FaceChart::point(const ChartPoint& c) const {
  return origin(c.height) + c.radius * direction(c.angle, c.height);
}

ChartPoint FaceChart::of(const Eigen::Vector3d& p) const {
  ChartPoint c;
  const double right = p.x() - x, front = p.z() - z, across = std::hypot(right, front);
  c.angle = std::atan2(right, front);
  const double rise = p.y() - std::clamp(p.y(), lower, upper);
  c.height = rise == 0 ? p.y() : std::clamp(p.y(), lower, upper) + nominal * std::atan2(rise, across);
  c.radius = std::hypot(across, rise);
  return c;
}

}  // namespace face
