#include "manipulators/face_fem/grid.h"

#include <cmath>

#include "manipulators/face_fem/shape.h"

namespace face {

Model grid(Element element, int nx, int ny, int nz,
           const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place) {
  Model model;
  model.element = element;
  // nodes live on a lattice of half steps; a serendipity element uses those with at most one odd coordinate
  const int step = nodes_of(element) == 20 ? 1 : 2;
  const std::array<int, 3> wide = {2 * nx + 1, 2 * ny + 1, 2 * nz + 1};
  const std::size_t lattice = std::size_t(wide[0]) * wide[1] * wide[2];
  std::vector<int> number(lattice, -1);
  const auto at = [&](int i, int j, int k) -> int& { return number[(std::size_t(k) * wide[1] + j) * wide[0] + i]; };
  for (int k = 0; k < wide[2]; k += step)
    for (int j = 0; j < wide[1]; j += step)
      for (int i = 0; i < wide[0]; i += step) {
        if (i % 2 + j % 2 + k % 2 > 1) continue;
        at(i, j, k) = int(model.nodes.size());
        model.nodes.push_back(place({0.5 * i / nx, 0.5 * j / ny, 0.5 * k / nz}));
      }
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        Hexahedron h;
        h.layer = k;
        for (int a = 0; a < nodes_of(element); ++a) {
          const Eigen::Vector3d& xi = reference_nodes()[a];
          h.node[a] = at(2 * i + 1 + int(xi.x()), 2 * j + 1 + int(xi.y()), 2 * k + 1 + int(xi.z()));
        }
        model.hexahedra.push_back(h);
      }
  return model;
}

std::vector<Side> grid_sides(int nx, int ny, int nz, int axis, bool far) {
  static constexpr int side_of[3][2] = {{5, 3}, {2, 4}, {0, 1}};
  const int count[3] = {nx, ny, nz};
  std::vector<Side> sides;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const int here[3] = {i, j, k};
        if (here[axis] == (far ? count[axis] - 1 : 0)) sides.push_back({(k * ny + j) * nx + i, side_of[axis][far]});
      }
  return sides;
}

std::vector<int> nodes_of_sides(const Model& model, const std::vector<Side>& sides) {
  Model shell;
  shell.element = model.element;
  shell.hexahedra = model.hexahedra;
  shell.skin = sides;
  return skin_nodes(shell);
}

Model cap(Element element, int nx, int ny, int nz, double poisson) {
  constexpr double radius = 0.080, thickness = 0.012, pi = 3.14159265358979323846;
  // x runs to the face's left, y up, z from the bone outward along the radius, which points to +Z in the middle
  Model model = grid(element, nx, ny, nz, [&](const Eigen::Vector3d& p) {
    const double left = (2 * p.x() - 1) * pi / 3, up = (2 * p.y() - 1) * 70 * pi / 180;
    const double r = radius - thickness * (1 - p.z());
    return Eigen::Vector3d(r * std::sin(left) * std::cos(up), r * std::sin(up), r * std::cos(left) * std::cos(up));
  });
  model.layers = {"deep", "fat", "skin"};
  model.bones = {"skull"};
  model.materials = {{"deep", 15e3, poisson, 1040}, {"fat", 5e3, poisson, 1040}, {"skin", 60e3, poisson, 1040}};
  for (Hexahedron& h : model.hexahedra) h.layer = h.material = (2 * h.layer + 1) * 3 / (2 * nz);
  for (int node : nodes_of_sides(model, grid_sides(nx, ny, nz, 2, false))) {
    Support support;
    support.node = node;
    model.supports.push_back(support);
  }
  model.skin = grid_sides(nx, ny, nz, 2, true);
  return model;
}

}  // namespace face
