#pragma once

#include <array>
#include <vector>

#include "manipulators/face_fem/ordering.h"
#include "manipulators/face_fem/stiffness.h"

namespace face {

/// The free part of K in the order of elimination: blocks of the lower triangle by columns, held axes of partly held
/// nodes cut out (their diagonal entry stays, so that they solve to zero for a zero load).
struct Ordered {
  std::vector<int> start;     ///< #free + 1
  std::vector<int> row;       ///< places
  std::vector<double> block;  ///< 9 an entry, row-major
};
Ordered put_in_order(const Stiffness& K, const std::vector<std::array<bool, 3>>& held, const Symbolic& symbolic);

/// The error of a pivot (row in elimination order) that is not positive.
Error bad_pivot(const Symbolic& symbolic, int pivot);

/// Numbers of L. Error `indefinite` names the node and axis whose pivot is not positive.
Result<Panels<double>> eliminate_fronts(const Ordered& A, const Symbolic& symbolic);
Result<Panels<double>> eliminate_cholmod(const Ordered& A, const Symbolic& symbolic);

/// L x = b, then L^T x = b, for one right-hand side in elimination order (3 #free numbers), in place.
void forward(const Symbolic& symbolic, const Panels<double>& L, double* x);
void backward(const Symbolic& symbolic, const Panels<double>& L, double* x);
void forward(const Symbolic& symbolic, const Panels<float>& L, float* x);
void backward(const Symbolic& symbolic, const Panels<float>& L, float* x);

/// Both, for `count` right-hand sides; x holds all of them for one row of L, then for the next.
void solve_many(const Symbolic& symbolic, const Panels<double>& L, double* x, int count);

/// L L^T + sign W W^T, in place: three rows of W belong to each of `places`, which are rows of one column of L (a
/// clique of the graph). Rotations (sign +1) or mixed hyperbolic rotations (-1), one row of L^T after the other, from
/// the first of the places up to the root. Returns the row whose pivot is not positive, or -1.
int update_panels(const Symbolic& symbolic, Panels<double>& L, const std::vector<int>& places, const Eigen::MatrixXd& W,
                  int sign);

}  // namespace face
