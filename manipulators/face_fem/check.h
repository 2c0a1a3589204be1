#pragma once

#include <vector>

#include "manipulators/face_fem/model.h"

namespace face {

/// Says whether a model can be solved, before anything is computed. One error, the first found, in this order:
/// `not_finite` (a coordinate, constant or shift), `material` (E <= 0, nu outside (-1, 0.5), density < 0), `unknown`
/// (an index out of range), `element` (a node twice in a brick that is no wedge), `numbering` (all corner Jacobians
/// negative: listed inside out), `inverted` (some are: a corner, mid-edge node or integration point), `mesh` (a side
/// shared by more than two elements), `unsupported` (a connected part whose supports leave it a rigid motion). Cost:
/// linear. What only numbers can show (`zero_mode`, `conditioning`) the factorisation finds.
Status check(const Model& model);

/// Nodes that no hexahedron uses, rising; they do not move.
std::vector<int> unused_nodes(const Model& model);

/// For each node the number of its connected part, -1 for unused nodes; parts are counted from 0.
std::vector<int> parts_of(const Model& model);

}  // namespace face
