#include "manipulators/face_fem/model.h"

#include <algorithm>

namespace face {

const std::array<std::array<int, 8>, 6> side_nodes = {{{0, 3, 2, 1, 11, 10, 9, 8},
                                                       {4, 5, 6, 7, 12, 13, 14, 15},
                                                       {0, 1, 5, 4, 8, 17, 12, 16},
                                                       {1, 2, 6, 5, 9, 18, 13, 17},
                                                       {2, 3, 7, 6, 10, 19, 14, 18},
                                                       {3, 0, 4, 7, 11, 16, 15, 19}}};

Lame Material::lame() const {
  return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
}

int Model::label_of_node(int node) const {
  return node_label.empty() ? node + 1 : node_label[static_cast<std::size_t>(node)];
}

int Model::label_of_hexahedron(int hexahedron) const {
  return hexahedron_label.empty() ? hexahedron + 1 : hexahedron_label[static_cast<std::size_t>(hexahedron)];
}

Corners corners_of(const Model& model, int hexahedron) {
  const int count = nodes_of(model.element);
  const auto& node = model.hexahedra[hexahedron].node;
  Corners X(3, count);
  for (int a = 0; a < count; ++a) X.col(a) = model.nodes[node[a]];
  return X;
}

namespace {

void sort_unique(std::vector<int>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

std::vector<int> skin_nodes(const Model& model) {
  const int corners = nodes_of(model.element) == 20 ? 8 : 4;
  std::vector<int> nodes;
  nodes.reserve(model.skin.size() * corners);
  for (const Side& side : model.skin)
    for (int k = 0; k < corners; ++k) nodes.push_back(model.hexahedra[side.hexahedron].node[side_nodes[side.side][k]]);
  sort_unique(nodes);
  return nodes;
}

std::vector<int> held_nodes(const Model& model) {
  std::vector<int> nodes;
  nodes.reserve(model.supports.size());
  for (const Support& support : model.supports) nodes.push_back(support.node);
  sort_unique(nodes);
  return nodes;
}

}  // namespace face
