#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "manipulators/face_fem/huge_pages.h"
#include "manipulators/face_fem/stiffness.h"

namespace face {

/// How the nodes are put in order before elimination.
enum class Order {
  metis,  ///< nested dissection of the node graph (Karypis and Kumar 1998); least fill on solid meshes
  amd,    ///< approximate minimum degree; quicker to find, more fill
};

/// Which entries the Cholesky factor of the free nodes will have, found on the graph of nodes: a ninth of the work of
/// the graph of degrees of freedom. Columns with like entries are gathered in supernodes; all counts are of nodes,
/// each of which stands for three rows.
struct Symbolic {
  std::vector<int> node;       ///< #free: which mesh node stands at each place of the order
  std::vector<int> place;      ///< #nodes: inverse of `node`, -1 for nodes held along all axes or unused
  std::vector<int> first;      ///< #supernodes + 1: first place of each
  std::vector<int> parent;     ///< #supernodes: supernode that it updates next, -1 at a root; parents come later
  std::vector<int> row_start;  ///< #supernodes + 1: where its rows begin in `row`
  std::vector<int> row;        ///< places, rising; its own columns first
  std::vector<std::size_t> panel_start;  ///< #supernodes + 1: where its panel begins among the numbers of L
  double nonzeros = 0;                   ///< of L, lower triangle
  double flops = 0;                      ///< of factoring

  int supernodes() const { return static_cast<int>(parent.size()); }
  int columns(int s) const { return first[s + 1] - first[s]; }
  int rows(int s) const { return row_start[s + 1] - row_start[s]; }
  const int* rows_of(int s) const { return row.data() + row_start[s]; }
  int free_nodes() const { return static_cast<int>(node.size()); }
};

/// Orders and analyses. `free[n]` says whether node n has a free axis. Errors: `limit` out of memory.
Result<Symbolic> analyse(const Stiffness& K, const std::vector<bool>& free, Order order);

/// The numbers of L: panel s is a column-major 3 rows(s) by 3 columns(s) array; what stands above its diagonal is
/// not part of L and never read.
template <class Real>
using Panels = HugeArray<Real>;

}  // namespace face
