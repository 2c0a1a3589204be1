#include "manipulators/face_fem/load.h"

#include <Eigen/Dense>

#include "manipulators/face_fem/shape.h"

namespace face {
namespace {

/// which reference axis is constant on each side, and its value there
constexpr int side_axis[6] = {2, 2, 1, 0, 1, 0};
constexpr double side_value[6] = {-1, 1, -1, 1, 1, -1};

}  // namespace

void add_pressure(const Model& model, Side side, double pressure, Field& load) {
  const int n = nodes_of(model.element), fixed = side_axis[side.side];
  const Corners X = corners_of(model, side.hexahedron);
  const Line& line = gauss_line(n == 20 ? 3 : 2);
  const int first = (fixed + 1) % 3, second = (fixed + 2) % 3;
  for (int i = 0; i < line.count; ++i)
    for (int j = 0; j < line.count; ++j) {
      Eigen::Vector3d xi;
      xi[fixed] = side_value[side.side];
      xi[first] = line.position[i];
      xi[second] = line.position[j];
      double N[20];
      shape(n, xi, N);
      const Eigen::Matrix3d J = jacobian(X, xi);
      // the area vector that points out of the element
      const Eigen::Vector3d tangent = J.row(first), other = J.row(second);
      const Eigen::Vector3d area = side_value[side.side] * tangent.cross(other);
      for (int a = 0; a < n; ++a)
        load.col(model.hexahedra[side.hexahedron].node[a]) -= line.weight[i] * line.weight[j] * pressure * N[a] * area;
    }
}

void add_gravity(const Model& model, int hexahedron, const Eigen::Vector3d& acceleration, Field& load) {
  const Rule& rule = rule_of(model.element);
  const Hexahedron& h = model.hexahedra[hexahedron];
  const Corners X = corners_of(model, hexahedron);
  const Eigen::Vector3d density = model.materials[h.material].density * acceleration;
  for (int q = 0; q < rule.points; ++q) {
    const double weight = rule.weight[q] * jacobian(X, rule.xi[q]).determinant();
    for (int a = 0; a < rule.nodes; ++a) load.col(h.node[a]) += weight * rule.N[q][a] * density;
  }
}

}  // namespace face
