#pragma once

#include <Eigen/Core>

#include "manipulators/face_fem/stiffness.h"

namespace face {

/// Stress at the nodes, 6 by #nodes, rows xx yy zz xy yz zx, pascals: each element's stress carried to its nodes
/// (element.h), then the mean over the elements around a node. Across a border of materials the mean hides a jump.
Eigen::Matrix<double, 6, Eigen::Dynamic> stress_field(const Model& model, const Field& u);

}  // namespace face
