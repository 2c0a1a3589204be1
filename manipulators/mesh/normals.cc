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

namespace {

/// Twice the area of a face along its normal.
Eigen::RowVector3f area(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F, Eigen::Index f) {
  const Eigen::RowVector3f a = V.row(F(f, 0));
  return (V.row(F(f, 1)) - a).cross(V.row(F(f, 2)) - a);
}

/// Makes the sum at v a unit vector, or takes it over from the vertex in the same place, which comes before v.
void finish(const Eigen::VectorXi& weld, Eigen::Index v, Eigen::MatrixX3f& N) {
  if (weld[v] == v) {
    const float length = N.row(v).norm();
    N.row(v) = length > 0 ? Eigen::RowVector3f(N.row(v) / length) : Eigen::RowVector3f::UnitY();
  } else {
    N.row(v) = N.row(weld[v]);
  }
}

}  // namespace

void vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld,
                    Eigen::MatrixX3f& N) {
  N.setZero(V.rows(), 3);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Eigen::RowVector3f normal = area(V, F, f);
    for (int corner = 0; corner < 3; ++corner) {
      N.row(weld[F(f, corner)]) += normal;
    }
  }
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    finish(weld, v, N);
  }
}

Eigen::MatrixX3f vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F) {
  Eigen::MatrixX3f N;
  vertex_normals(V, F, welded(V), N);
  return N;
}

Patch patch_around(const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld, std::vector<int> moved) {
  Patch patch;
  patch.moved = std::move(moved);
  std::sort(patch.moved.begin(), patch.moved.end());
  patch.moved.erase(std::unique(patch.moved.begin(), patch.moved.end()), patch.moved.end());

  // places, by the number of the first vertex there: those that move, and those with a face that does
  std::vector<bool> moves(weld.size(), false), changes(weld.size(), false);
  for (int v : patch.moved) {
    moves[weld[v]] = changes[weld[v]] = true;
  }
  const auto touches = [&](const std::vector<bool>& places, Eigen::Index f) {
    return places[weld[F(f, 0)]] || places[weld[F(f, 1)]] || places[weld[F(f, 2)]];
  };
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int corner = 0; touches(moves, f) && corner < 3; ++corner) {
      changes[weld[F(f, corner)]] = true;
    }
  }
  for (Eigen::Index v = 0; v < weld.size(); ++v) {
    if (changes[weld[v]]) {
      patch.vertices.push_back(static_cast<int>(v));
    }
  }
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (touches(changes, f)) {
      patch.faces.push_back(static_cast<int>(f));
    }
  }
  return patch;
}

void vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld,
                    const Patch& patch, Eigen::MatrixX3f& N) {
  // places beyond the patch would get incomplete sums: they are left out
  std::vector<bool> inside(V.rows(), false);
  for (int v : patch.vertices) {
    N.row(v).setZero();
    inside[v] = true;
  }
  for (int f : patch.faces) {
    const Eigen::RowVector3f normal = area(V, F, f);
    for (int corner = 0; corner < 3; ++corner) {
      const int v = weld[F(f, corner)];
      if (inside[v]) {
        N.row(v) += normal;
      }
    }
  }
  for (int v : patch.vertices) {
    finish(weld, v, N);
  }
}

}  // namespace mesh
