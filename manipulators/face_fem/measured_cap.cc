#include "manipulators/face_fem/measured_cap.h"

#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/grid.h"
#include "manipulators/face_fem/shape.h"

namespace face {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double widest = pi / 3, highest = 70 * pi / 180;  // of the cap

/// the fraction of a low-discrepancy sequence (Kronecker), so that samples are even and the same everywhere
double strewn(int k, double step) { return std::fmod((k + 0.5) * step, 1.0); }

}  // namespace

Eigen::Vector3d cap_place(double left, double up, double r) {
  return {r * std::sin(left) * std::cos(up), r * std::sin(up), r * std::cos(left) * std::cos(up)};
}

std::vector<Muscle> cap_muscles(int count, double radius) {
  std::vector<Muscle> muscles;
  for (int k = 0; k < count; ++k) {
    const double left = 0.75 * widest * (2 * strewn(k, 0.7548776662466927) - 1);
    const double up = 0.75 * highest * (2 * strewn(k, 0.5698402909980532) - 1);
    // from bone a quarter of the way to the rim into the middle of the tissue
    const Eigen::Vector3d insertion = cap_place(left, up, 0.0735);
    const Eigen::Vector3d origin = cap_place(left + (left > 0 ? -0.25 : 0.25), up + (up > 0 ? -0.15 : 0.15), 0.068);
    muscles.push_back({"muscle" + std::to_string(k + 1), {{origin, insertion, 0, radius, 0.2}}});
  }
  return muscles;
}

Eigen::Matrix3Xd surface_samples(const Model& model, const Mesh& mesh, const Field& u, int side) {
  Eigen::Matrix3Xd samples(3, side * side);
  const int nodes = nodes_of(model.element);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double x = (i + 0.5) / side * mesh.nx, y = (j + 0.5) / side * mesh.ny;
      const int ex = std::min(int(x), mesh.nx - 1), ey = std::min(int(y), mesh.ny - 1);
      const Hexahedron& h = model.hexahedra[((mesh.nz - 1) * mesh.ny + ey) * mesh.nx + ex];
      double N[20];
      shape(nodes, {2 * (x - ex) - 1, 2 * (y - ey) - 1, 1}, N);
      samples.col(j * side + i).setZero();
      for (int a = 0; a < nodes; ++a) samples.col(j * side + i) += N[a] * u.col(h.node[a]);
    }
  return samples;
}

double relative_difference(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) { return (a - b).norm() / b.norm(); }

Eigen::Matrix3Xd cap_vertices(int count) {
  Eigen::Matrix3Xd vertices(3, count);
  for (int k = 0; k < count; ++k)
    vertices.col(k) = cap_place(widest * (2 * strewn(k, 0.7548776662466927) - 1),
                                highest * (2 * strewn(k, 0.5698402909980532) - 1), 0.080);
  return vertices;
}

}  // namespace face
