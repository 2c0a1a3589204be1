#pragma once

#include "manipulators/face_fem/face.h"
#include "manipulators/face_fem/grid.h"

namespace face {

/// A slab of tissue with a mouth: 60 mm wide, 80 mm high, 12 mm thick, on bone that is skull above and jaw below the
/// lips, the hinge 80 mm behind and 40 mm above them. The smallest thing that has all a face needs but eyes.
inline Face toy_face() {
  constexpr int nx = 10, ny = 10, nz = 3;
  Face face;
  Model& model = face.model;
  model = grid(Element::bbar, nx, ny, nz, [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(0.06 * (p.x() - 0.5), 0.08 * (p.y() - 0.5), 0.012 * p.z());
  });
  model.materials = {{"tissue", 10e3, 0.45, 1000}};
  model.layers = {"deep", "fat", "skin"};
  model.bones = {"skull", "jaw"};
  const auto number = [&](int x, int y, int z) { return x + (nx + 1) * (y + (ny + 1) * z); };

  // the lower lip gets nodes of its own along the middle row
  constexpr int first = 3, last = 7, row = ny / 2;
  face.lips.columns = last - first + 1;
  face.lips.levels = nz + 1;
  std::vector<int> twin(model.nodes.size(), -1);
  for (int x = first; x <= last; ++x)
    for (int z = 0; z <= nz; ++z) {
      const int upper = number(x, row, z);
      twin[std::size_t(upper)] = int(model.nodes.size());
      const Eigen::Vector3d place = model.nodes[std::size_t(upper)];
      model.nodes.push_back(place);
      face.lips.pairs.push_back({upper, twin[std::size_t(upper)], x - first, z, Eigen::Vector3d::UnitY()});
    }
  for (std::size_t e = 0; e < model.hexahedra.size(); ++e) {
    if (int(e) / nx % ny >= row) continue;
    for (int& node : model.hexahedra[e].node)
      if (node < int(twin.size()) && twin[std::size_t(node)] >= 0) node = twin[std::size_t(node)];
  }
  for (int node = 0; node < int(model.nodes.size()); ++node) {
    const Eigen::Vector3d& p = model.nodes[std::size_t(node)];
    if (p.z() > 1e-9) continue;
    Support support;
    support.node = node;
    const bool lower_lip = node >= int(twin.size());
    support.bone = p.y() < -1e-9 || lower_lip ? 1 : 0;
    model.supports.push_back(support);
  }
  model.skin = grid_sides(nx, ny, nz, 2, true);

  const auto strand = [](double x0, double y0, double x1, double y1, double force) {
    return Strand{{x0, y0, 0.002}, {x1, y1, 0.008}, 0, 0.005, force};
  };
  face.muscles = {{"left_zygomaticus_major", {strand(0.028, 0.03, 0.015, 0.0, 0.3)}},
                  {"right_zygomaticus_major", {strand(-0.028, 0.03, -0.015, 0.0, 0.3)}},
                  {"left_depressor_labii", {strand(0.008, -0.03, 0.006, -0.005, 0.3)}},
                  {"right_depressor_labii", {strand(-0.008, -0.03, -0.006, -0.005, 0.3)}},
                  {"mentalis", {strand(0, 0.03, 0, -0.008, 0.5)}}};
  face.jaw.centre = {0, 0.04, -0.08};
  std::vector<FaceCarrier::Row> rows;
  for (int node : skin_nodes(model)) rows.push_back({int(rows.size()), {node}, {1.0f}});
  face.carrier = FaceCarrier(rows);
  return face;
}

}  // namespace face
