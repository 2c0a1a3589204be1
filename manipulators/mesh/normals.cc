#include "manipulators/mesh/normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace mesh {

Eigen::VectorXi welded(const Eigen::MatrixX3f& V) {
  const auto before = [&](int a, int b) {
    for (int axis = 0; axis < 3; ++axis) {
      if (V(a, axis) != V(b, axis)) {
        return V(a, axis) < V(b, axis);
      }
    }
    return a < b;
  };
  std::vector<int> order(V.rows());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), before);

  Eigen::VectorXi weld(V.rows());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && V.row(order[i]) == V.row(order[i - 1]);
    weld[order[i]] = same ? weld[order[i - 1]] : order[i];
  }
  return weld;
}

void vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld,
                    Eigen::MatrixX3f& N) {
  N.setZero(V.rows(), 3);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Eigen::RowVector3f a = V.row(F(f, 0));
    const Eigen::RowVector3f normal = (V.row(F(f, 1)) - a).cross(V.row(F(f, 2)) - a);
    for (int corner = 0; corner < 3; ++corner) {
      N.row(weld[F(f, corner)]) += normal;
    }
  }
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    if (weld[v] == v) {
      const float length = N.row(v).norm();
      N.row(v) = length > 0 ? Eigen::RowVector3f(N.row(v) / length) : Eigen::RowVector3f::UnitY();
    } else {
      N.row(v) = N.row(weld[v]);
    }
  }
}

Eigen::MatrixX3f vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F) {
  Eigen::MatrixX3f N;
  vertex_normals(V, F, welded(V), N);
  return N;
}

}  // namespace mesh
