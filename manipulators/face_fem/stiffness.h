#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/face_fem/model.h"

namespace face {

/// Nodal vectors (displacement, metres; force, newtons): 3 by #nodes.
using Field = Eigen::Matrix3Xd;

/// The global stiffness matrix of all nodes, held or not: symmetric, in 3 by 3 blocks of node pairs, lower triangle
/// by columns.
struct Stiffness {
  int nodes = 0;
  std::vector<int> start;     ///< #nodes + 1; column c has the entries start[c] .. start[c + 1]
  std::vector<int> row;       ///< node of the entry, >= c, rising; a node of an element has its diagonal first
  std::vector<double> block;  ///< 9 an entry, row-major, N/m; diagonal blocks are full

  /// The entry of the pair (row >= column), which some element must share.
  int entry(int row_node, int column) const;
};

/// Sums the element stiffnesses. Cost: linear in the elements. Errors: `inverted` when a Jacobian is not positive at
/// an integration point, `not_finite` when a sum is not finite.
Result<Stiffness> assemble(const Model& model);

/// Adds `factor` times the stiffness of one element.
void add_element(const Model& model, int hexahedron, double factor, Stiffness& K);

/// K u, newtons.
Field multiply(const Stiffness& K, const Field& u);

}  // namespace face
