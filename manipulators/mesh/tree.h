#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace mesh {

/// Boxes around boxes around the faces of a surface that does not move: answers whether a straight line is blocked
/// and where a line first meets the surface, in about log(#F) steps. Keeps references: V and F must outlive it.
class Tree {
 public:
  Tree(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F);

  /// Where a line first meets a face.
  struct Hit {
    int face = -1;     ///< -1: none
    double share = 1;  ///< of the way from a to b, in (0, 1)
  };

  /// The first face met on the way from `a` to `b`, both ends excluded.
  Hit first_hit(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  /// All crossings on the way, sorted by share; a crossing through an edge may appear twice.
  std::vector<Hit> hits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int left = -1, right = -1;  ///< children; or, in a leaf, left = -1
    int begin = 0, end = 0;     ///< faces_[begin, end) in a leaf
  };

  int build(int begin, int end);
  template <class Visit>
  void walk(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const double& reach, Visit visit) const;

  const Eigen::MatrixX3f& V_;
  const Eigen::MatrixX3i& F_;
  std::vector<int> faces_;
  std::vector<Node> nodes_;
};

}  // namespace mesh
