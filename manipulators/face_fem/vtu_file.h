#pragma once

#include <string>

#include "manipulators/face_fem/stiffness.h"

namespace face {

/// Writes a VTK unstructured grid for ParaView: nodes at rest, hexahedra, point data `displacement` and (when given,
/// 6 by #nodes in the order xx yy zz xy yz zx) `stress`, cell data `material` and `layer`. Error `io`.
Status write_vtu(const std::string& path, const Model& model, const Field& u,
                 const Eigen::Matrix<double, 6, Eigen::Dynamic>& stress = {});

}  // namespace face
