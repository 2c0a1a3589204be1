#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/mesh/surface.h"

namespace figure {

/// A closed curve where a plane cuts a surface.
struct Loop {
  std::vector<Eigen::Vector3d> points;                 ///< metres, in order
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< of the area inside
  double area = 0;                                     ///< square metres
  double perimeter = 0;                                ///< metres
};

/// The closed loops of `surface` in the plane through `point` with unit `normal`, largest area first. Open curves,
/// from surfaces with a border, are left out.
std::vector<Loop> section(const mesh::Surface& surface, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace figure
