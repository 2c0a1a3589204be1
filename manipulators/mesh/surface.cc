#include "manipulators/mesh/surface.h"

#include <algorithm>

namespace mesh {

Bounds bounds(const Surface& surface) {
  if (surface.V.rows() == 0) {
    return {Eigen::Vector3f::Constant(1), Eigen::Vector3f::Constant(-1)};
  }
  return {surface.V.colwise().minCoeff().transpose(), surface.V.colwise().maxCoeff().transpose()};
}

void append(Surface& surface, const Surface& other) {
  const Eigen::Index vertices = surface.V.rows();
  const Eigen::Index faces = surface.F.rows();
  const bool normals = surface.N.rows() == vertices && other.N.rows() == other.V.rows();

  surface.V.conservativeResize(vertices + other.V.rows(), 3);
  surface.V.bottomRows(other.V.rows()) = other.V;
  surface.F.conservativeResize(faces + other.F.rows(), 3);
  surface.F.bottomRows(other.F.rows()) = other.F.array() + static_cast<int>(vertices);
  surface.N.conservativeResize(normals ? surface.V.rows() : 0, 3);
  if (normals) {
    surface.N.bottomRows(other.V.rows()) = other.N;
  }

  std::vector<int> renamed;
  for (const std::string& name : other.part_names) {
    const auto found = std::find(surface.part_names.begin(), surface.part_names.end(), name);
    renamed.push_back(static_cast<int>(found - surface.part_names.begin()));
    if (found == surface.part_names.end()) {
      surface.part_names.push_back(name);
    }
  }
  for (int part : other.part) {
    surface.part.push_back(renamed[part]);
  }
}

Surface subset(const Surface& surface, const std::vector<bool>& keep, std::vector<int>* vertex_map) {
  std::vector<int> renumbered(surface.V.rows(), -1);
  std::vector<int> kept_vertices;
  std::vector<Eigen::Index> kept_faces;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    if (!keep[f]) {
      continue;
    }
    kept_faces.push_back(f);
    for (int corner = 0; corner < 3; ++corner) {
      int& number = renumbered[surface.F(f, corner)];
      if (number < 0) {
        number = static_cast<int>(kept_vertices.size());
        kept_vertices.push_back(surface.F(f, corner));
      }
    }
  }

  Surface result;
  result.part_names = surface.part_names;
  result.V.resize(kept_vertices.size(), 3);
  result.N.resize(surface.N.rows() == surface.V.rows() ? kept_vertices.size() : 0, 3);
  for (std::size_t v = 0; v < kept_vertices.size(); ++v) {
    result.V.row(v) = surface.V.row(kept_vertices[v]);
    if (result.N.rows() > 0) {
      result.N.row(v) = surface.N.row(kept_vertices[v]);
    }
  }
  result.F.resize(kept_faces.size(), 3);
  for (std::size_t f = 0; f < kept_faces.size(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      result.F(f, corner) = renumbered[surface.F(kept_faces[f], corner)];
    }
    result.part.push_back(surface.part[kept_faces[f]]);
  }
  if (vertex_map != nullptr) {
    *vertex_map = kept_vertices;
  }
  return result;
}

}  // namespace mesh
