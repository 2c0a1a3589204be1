#pragma once

#include <Eigen/Core>
#include <vector>

namespace face {

/// Carries the motion of tissue nodes to the vertices of the head: each vertex moves by a weighted sum of nodes,
/// weights found once. Across the tissue the sum is a smooth (C1) interpolation of the skin's nodes; vertices of upper
/// and lower lip, and of upper and lower lid, follow their own side of the slit, inside of the mouth the bone they lie
/// on; beyond the tissue's border the motion fades to zero with a slope of zero.
class FaceCarrier {
 public:
  /// Weights row by row; rows of vertices that do not move are absent.
  struct Row {
    int vertex;
    std::vector<int> node;      ///< indices into Model::nodes
    std::vector<float> weight;  ///< same length; sums to at most 1
  };

  FaceCarrier() = default;
  explicit FaceCarrier(const std::vector<Row>& rows);

  /// The nodes that are read, rising: what to give to Basis.
  const std::vector<int>& nodes() const { return nodes_; }
  /// The vertices of the head that move, rising; their number is a fraction of the head's.
  const std::vector<int>& vertices() const { return vertices_; }

  /// Displacement of vertices() (x y z in turn, 3 #vertices() floats) from that of nodes() (Basis::frame), metres.
  void carry(const float* node_displacement, float* vertex_displacement) const;

 private:
  std::vector<int> nodes_, vertices_;
  std::vector<int> start_;     // #vertices + 1
  std::vector<int> source_;    // place in nodes_
  std::vector<float> weight_;  // of each source
};

}  // namespace face
