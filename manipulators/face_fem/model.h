#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "manipulators/face_fem/element.h"

namespace face {

/// Isotropic linear elastic tissue.
struct Material {
  std::string name;
  double young = 0;    ///< E, pascals, > 0
  double poisson = 0;  ///< nu, in (-1, 0.5); above 0.4999 only the mean-dilatation element keeps its digits
  double density = 0;  ///< kg/m3, >= 0; only gravity reads it

  Lame lame() const;
};

/// A brick of tissue.
struct Hexahedron {
  std::array<int, 20> node{};  ///< indices into Model::nodes, 8 or 20 used, in the order of element.h; two neighbours
                               ///< may be equal in an 8-node brick, which makes it a wedge
  int material = 0;            ///< index into Model::materials
  int layer = 0;               ///< index into Model::layers
};

/// Axes of a node whose displacement is given.
struct Support {
  int node = 0;
  std::array<bool, 3> held = {true, true, true};
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< displacement along the held axes, metres
  int bone = 0;                                     ///< index into Model::bones: what the node is fixed to
};

/// One side of a hexahedron, 0-based in the order of Abaqus: 0 nodes 1234, 1 5678, 2 1562, 3 2673, 4 3784, 5 4851.
struct Side {
  int hexahedron = 0;
  int side = 0;
};

/// Corners of the sides of a hexahedron, listed so that their normal points out of it; then the mid-edge nodes
/// between corner k and k+1.
extern const std::array<std::array<int, 8>, 6> side_nodes;

/// Soft tissue between bone and skin: where everything that builds, checks, solves or writes a face meets.
/// Metres, newtons, pascals. Plain data; check.h says whether it can be solved.
struct Model {
  Element element = Element::bbar;
  std::vector<Eigen::Vector3d> nodes;  ///< positions at rest
  std::vector<Hexahedron> hexahedra;   ///< all with nodes_of(element) nodes
  std::vector<Material> materials;
  std::vector<std::string> layers;  ///< names, from the bone outward ("deep" "fat" "skin"); may be empty
  std::vector<std::string> bones;   ///< names ("skull" "jaw"); may be empty
  std::vector<Support> supports;    ///< at most one for each node
  std::vector<Side> skin;           ///< the outer surface

  std::vector<int> node_label;        ///< what a file calls the nodes; empty: 1, 2, 3 ...
  std::vector<int> hexahedron_label;  ///< likewise

  int label_of_node(int node) const;
  int label_of_hexahedron(int hexahedron) const;
};

/// Positions of a hexahedron's nodes, 3 by 8 or 20.
Corners corners_of(const Model& model, int hexahedron);

/// Nodes that the skin touches, each once, rising.
std::vector<int> skin_nodes(const Model& model);

/// Nodes that the supports touch (any axis), rising.
std::vector<int> held_nodes(const Model& model);

}  // namespace face
