#pragma once

#include <vector>

#include "manipulators/face_fem/model.h"

namespace face {

/// Says whether a model can be solved, before anything is computed. One error, the first found, in this order:
/// `not_finite` (a coordinate, constant or shift), `material` (E <= 0, nu outside (-1, 0.5), density < 0), `unknown`
/// (an index out of range), `element` (a node twice in a brick that is no wedge), `numbering` (all corner Jacobians
/// negative: listed inside out), `mesh` (a side shared by more than two elements), `unsupported` (a connected part
/// whose supports leave it a rigid motion). Cost: linear. What only numbers can show (`inverted` at an integration
/// point, `zero_mode`, `conditioning`) assembling and factoring find.
Status check(const Model& model);

/// A brick whose Jacobian is not positive at a corner (or mid-edge node).
struct TurnedCorner {
  int hexahedron = 0;
  int node = 0;    ///< the worst corner, an index into Model::nodes
  double det = 0;  ///< Jacobian there, m3
};

/// All bricks with such a corner. They can still be solved when their integration points are positive - the patch
/// cube of MacNeal and Harder has one - but the map from reference to space folds there, so the answer is told with
/// a warning. Collapsed corners of wedges are not counted.
std::vector<TurnedCorner> turned_corners(const Model& model);

/// Nodes that no hexahedron uses, rising; they do not move.
std::vector<int> unused_nodes(const Model& model);

/// For each node the number of its connected part, -1 for unused nodes; parts are counted from 0.
std::vector<int> parts_of(const Model& model);

}  // namespace face
