#pragma once

#include <Eigen/Core>
#include <functional>

#include "manipulators/face_fem/model.h"

namespace face {

/// A structured block of nx by ny by nz hexahedra: `place` takes (x, y, z) in [0, 1]^3 to space and must keep the
/// handedness. Hexahedra run x fastest, then y, then z; 20-node elements get their mid-edge nodes from `place` too,
/// so curved sides are followed. No supports, materials or skin; hexahedron.layer is its z index.
Model grid(Element element, int nx, int ny, int nz,
           const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place);

/// Reads off the sides at the end of axis (0 x, 1 y, 2 z) of a grid: far end if `far`.
std::vector<Side> grid_sides(int nx, int ny, int nz, int axis, bool far);

/// Nodes of a list of sides, each once, rising.
std::vector<int> nodes_of_sides(const Model& model, const std::vector<Side>& sides);

/// The layered spherical cap that stands for a cheek: radius 80 mm outside, 12 mm thick, +-60 by +-70 degrees, bone
/// side held, skin on the outside, thirds of deep tissue, fat and skin (15, 5, 60 kPa, nu 0.45); nz must be a
/// multiple of 3 for the layers to end at sides, else an element belongs to the layer of its middle.
Model cap(Element element, int nx, int ny, int nz, double poisson = 0.45);

}  // namespace face
