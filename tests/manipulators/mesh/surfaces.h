#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "manipulators/mesh/normals.h"
#include "manipulators/mesh/surface.h"

/// Surfaces whose properties are known.
namespace known {

inline mesh::Surface of(const std::vector<Eigen::RowVector3f>& V, const std::vector<Eigen::RowVector3i>& F) {
  mesh::Surface surface;
  surface.V.resize(V.size(), 3);
  for (std::size_t v = 0; v < V.size(); ++v) surface.V.row(v) = V[v];
  surface.F.resize(F.size(), 3);
  for (std::size_t f = 0; f < F.size(); ++f) surface.F.row(f) = F[f];
  surface.part.assign(F.size(), 0);
  surface.part_names = {"skin"};
  surface.N = mesh::vertex_normals(surface.V, surface.F);
  return surface;
}

/// A closed tube around +Y from y = 0 to y = length with flat ends, `rows` rings of `around` vertices.
inline mesh::Surface tube(double length, double radius, int rows = 40, int around = 24) {
  std::vector<Eigen::RowVector3f> V;
  std::vector<Eigen::RowVector3i> F;
  for (int row = 0; row < rows; ++row) {
    for (int step = 0; step < around; ++step) {
      const double angle = 2 * M_PI * step / around;
      V.emplace_back(radius * std::sin(angle), length * row / (rows - 1), radius * std::cos(angle));
    }
  }
  V.emplace_back(0, 0, 0);
  V.emplace_back(0, length, 0);
  for (int step = 0; step < around; ++step) {
    const int next = (step + 1) % around, top = (rows - 1) * around;
    F.emplace_back(rows * around, next, step);
    F.emplace_back(rows * around + 1, top + step, top + next);
    for (int row = 0; row + 1 < rows; ++row) {
      const int a = row * around + step, b = row * around + next;
      F.emplace_back(a, b, b + around);
      F.emplace_back(a, b + around, a + around);
    }
  }
  return of(V, F);
}

/// A unit cube from the origin, twelve faces, eight vertices.
inline mesh::Surface cube() {
  return of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}, {{0, 2, 3},
                                                                                                       {0, 3, 1},
                                                                                                       {4, 5, 7},
                                                                                                       {4, 7, 6},
                                                                                                       {0, 1, 5},
                                                                                                       {0, 5, 4},
                                                                                                       {2, 6, 7},
                                                                                                       {2, 7, 3},
                                                                                                       {0, 4, 6},
                                                                                                       {0, 6, 2},
                                                                                                       {1, 3, 7},
                                                                                                       {1, 7, 5}});
}

/// A sphere around the origin by latitude and longitude.
inline mesh::Surface sphere(double radius, int rows = 32, int around = 48) {
  mesh::Surface surface = tube(1, 1, rows, around);
  for (int row = 0; row < rows; ++row) {
    const double latitude = M_PI * ((row + 1.0) / (rows + 1) - 0.5);
    for (int step = 0; step < around; ++step) {
      const double angle = 2 * M_PI * step / around;
      surface.V.row(row * around + step) << radius * std::cos(latitude) * std::sin(angle), radius * std::sin(latitude),
          radius * std::cos(latitude) * std::cos(angle);
    }
  }
  surface.V.row(rows * around) << 0, -radius, 0;
  surface.V.row(rows * around + 1) << 0, radius, 0;
  surface.N = mesh::vertex_normals(surface.V, surface.F);
  return surface;
}

}  // namespace known
