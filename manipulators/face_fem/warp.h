#pragma once

#include <Eigen/Core>
#include <vector>

namespace face {

/// A thin-plate spline of space: the smoothest map that takes each `from` to its `to` (kernel |r|, affine part). Exact
/// at the pairs; an affine map between them comes back exactly (Bookstein 1989, three dimensions). At least 4 pairs
/// that do not lie in a plane.
class Warp {
 public:
  Warp(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to);
  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const;

 private:
  std::vector<Eigen::Vector3d> from_;
  Eigen::MatrixX3d weight_;  // #pairs + 4 rows: kernels, constant, x, y, z
};

}  // namespace face
