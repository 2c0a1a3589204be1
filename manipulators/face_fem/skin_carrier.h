#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/face_fem/model.h"

namespace face {

/// The polyhedral skin, carried by the outer sides of the elements: each vertex is bound to the nearest point of the
/// nearest side and moves as that point does, by the side's own shape functions.
class SkinCarrier {
 public:
  /// Binds `vertices` (metres, 3 by #vertices, at rest) to model.skin. Cost: once, about a microsecond times
  /// vertices times the square root of sides. Errors: `mesh` no skin; `not_finite`.
  static Result<SkinCarrier> bind(const Model& model, const Eigen::Matrix3Xd& vertices);

  int vertices() const { return static_cast<int>(vertex_.size()); }
  /// Distance of the vertex farthest from the skin at binding, metres; and of each.
  double farthest() const { return farthest_; }
  const std::vector<float>& distance() const { return distance_; }

  /// Displacements of the vertices (x y z in turn, 3 #vertices floats) from those of skin_nodes(model), in that
  /// order (Basis::frame). Reads two numbers a vertex, so 20 000 vertices take about 0.02 ms.
  void carry(const float* node_displacement, float* vertex_displacement) const;

 private:
  std::vector<std::array<int, 8>> corner_;  // of each side in use: places in skin_nodes(model)
  std::vector<int> start_;                  // #sides in use + 1: its vertices
  std::vector<float> s_, t_;                // reference coordinates on the side, sorted by side
  std::vector<int> vertex_;                 // which vertex each of them is
  std::vector<float> distance_;             // by vertex
  double farthest_ = 0;
  int corners_ = 4;
};

}  // namespace face
