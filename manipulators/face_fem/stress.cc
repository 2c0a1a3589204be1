#include "manipulators/face_fem/stress.h"

namespace face {

Eigen::Matrix<double, 6, Eigen::Dynamic> stress_field(const Model& model, const Field& u) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> sum = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, u.cols());
  Eigen::VectorXi count = Eigen::VectorXi::Zero(u.cols());
  const int nodes = nodes_of(model.element);
  for (int e = 0; e < int(model.hexahedra.size()); ++e) {
    const Hexahedron& h = model.hexahedra[e];
    Corners mine(3, nodes);
    for (int a = 0; a < nodes; ++a) mine.col(a) = u.col(h.node[a]);
    const auto stress = nodal_stress(model.element, corners_of(model, e), mine, model.materials[h.material].lame());
    for (int a = 0; a < nodes; ++a) {
      sum.col(h.node[a]) += stress.col(a);
      ++count[h.node[a]];
    }
  }
  for (int n = 0; n < u.cols(); ++n)
    if (count[n] > 0) sum.col(n) /= count[n];
  return sum;
}

}  // namespace face
