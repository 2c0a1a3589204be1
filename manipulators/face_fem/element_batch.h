#pragma once

#include "manipulators/face_fem/element.h"

namespace face {

/// Element stiffness for several hexahedra at a time, one in each lane of a vector register. The lanes never meet, so
/// an element's numbers are the same bits in whatever lane and on whatever processor they are computed.
constexpr int lanes = 4;
typedef double Lane __attribute__((vector_size(8 * lanes)));

/// Blocks of the lower triangle of n node pairs: pair (a, b), a >= b, stands at a (a + 1) / 2 + b.
constexpr int pair_index(int a, int b) { return a * (a + 1) / 2 + b; }
constexpr int pairs_of(int nodes) { return nodes * (nodes + 1) / 2; }

struct Batch {
  Lane X[20][3];      ///< in: node positions
  Lane lambda, mu;    ///< in: Lame's constants
  Lane K[210][3][3];  ///< out: block of each pair of nodes, K[pair][i][j] = d2W / du_ai du_bj
  Lane smallest;      ///< out: smallest Jacobian determinant at the integration points
  Lane volume;        ///< out
};

/// Fills the outputs. Lanes that are not wanted may repeat an element.
void fill_stiffness(Element element, Batch& batch);

}  // namespace face
