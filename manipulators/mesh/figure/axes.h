#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace figure {

/// A joint's line in space: a point on it and its unit direction, about which positive angles turn (right hand).
struct Axis {
  Eigen::Vector3d point, direction;
};

/// A row of a standard Denavit-Hartenberg table (Paul 1981): Rz(theta0 + q) Tz(d) Tx(a) Rx(alpha).
struct Dh {
  double theta0 = 0, d = 0, a = 0, alpha = 0;  ///< rad, m, m, rad
  Eigen::Isometry3d transform(double angle) const;
};

/// A chain in Denavit-Hartenberg form: base, one row a joint, tool.
struct DhChain {
  Eigen::Isometry3d base;
  std::vector<Dh> rows;
  Eigen::Isometry3d tool;
};

/// The chain whose joints, all at angle 0, turn about `axes` (at least one) and carry a frame that then stands at
/// `end`. All in one surrounding frame. Each frame's z lies on the next joint's axis and its x along the common
/// normal; the last row is the identity. Exact for skew, crossing and parallel axes (within 1e-9 rad of parallel).
DhChain denavit_hartenberg(const std::vector<Axis>& axes, const Eigen::Isometry3d& end);

}  // namespace figure
