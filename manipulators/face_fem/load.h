#pragma once

#include <Eigen/Core>

#include "manipulators/face_fem/stiffness.h"

namespace face {

/// Adds the nodal forces of a pressure (pascals, positive pushing into the element) on one side of an element at
/// rest, integrated with 2x2 points for 8-node and 3x3 for 20-node elements.
void add_pressure(const Model& model, Side side, double pressure, Field& load);

/// Adds the weight of one element: its density times `acceleration` (m/s2), integrated with the element's rule.
void add_gravity(const Model& model, int hexahedron, const Eigen::Vector3d& acceleration, Field& load);

}  // namespace face
