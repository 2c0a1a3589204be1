#pragma once

#include <Eigen/Core>

namespace face {

/// Where a point lies on the chart of a face.
struct ChartPoint {
  double angle = 0;   ///< about the vertical axis, radians; 0 to the front, positive to the person's left
  double height = 0;  ///< metres; between the bends it is y, beyond them the arc on the nominal radius
  double radius = 0;  ///< metres along the ray
};

/// The rays of the virtual scanner: those of a cylinder round a vertical axis between lips and brow; above and below
/// they fan out from a fixed point, so that forehead and underside of the chin are met squarely (a capsule).
/// Every point off the axis lies on one ray.
struct FaceChart {
  static constexpr double nominal = 0.090;  ///< metres: where an angle becomes a length

  double x = 0, z = 0;          ///< the axis
  double lower = 0, upper = 0;  ///< y of the bends
  double side = 1.3;            ///< largest angle to either side, radians
  double bottom = 0, top = 0;   ///< least and largest height

  Eigen::Vector3d origin(double height) const;
  Eigen::Vector3d direction(double angle, double height) const;
  Eigen::Vector3d point(const ChartPoint& c) const;
  ChartPoint of(const Eigen::Vector3d& p) const;
};

}  // namespace face
