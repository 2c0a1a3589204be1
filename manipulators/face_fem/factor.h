#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "manipulators/face_fem/ordering.h"
#include "manipulators/face_fem/stiffness.h"

namespace face {

/// Who computes the numbers of the factor. Both fill the same panels, so solving does not differ.
enum class Elimination {
  fronts,   ///< our multifrontal elimination, dense fronts of three rows a node
  cholmod,  ///< cholmod_super_numeric of SuiteSparse
};

struct FactorOptions {
  Order order = Order::metis;
  Elimination elimination = Elimination::fronts;
};

/// What factoring cost. Times are CPU seconds of this thread.
struct FactorCost {
  double order_seconds = 0, factor_seconds = 0;
  double nonzeros = 0;  ///< of L
  double flops = 0;     ///< of the factorisation
  double bytes = 0;     ///< of the panels
};

/// Cholesky factor K = L L^T over the free degrees of freedom, made once and used for every load. A solve reads L
/// twice and is limited by memory bandwidth; solving many loads together is cheaper than one by one.
/// Held rows of right-hand sides are ignored and come out as zero.
class Factor {
 public:
  /// `held` has three flags a node. Errors: `indefinite` with the node and axis of the pivot, `conditioning` when
  /// rcond() < 1e-12 (a mechanism, or a zero mode of hex20r), `not_finite`, `limit`.
  static Result<Factor> make(const Stiffness& K, const std::vector<std::array<bool, 3>>& held,
                             const FactorOptions& options = {});

  /// New numbers for the same pattern and supports; the order is kept. Errors as make(); the factor is then unusable.
  Status refactor(const Stiffness& K);

  Factor(Factor&&) noexcept;
  Factor& operator=(Factor&&) noexcept;
  ~Factor();

  /// x with K x = f.
  Field solve(const Field& f) const;
  /// The same with L in single precision: half the memory traffic, relative error about 1e-7 times the condition of
  /// the problem (measured 1e-7 on tissue). The copy of L is made at the first call.
  Field solve_single(const Field& f) const;
  /// Many loads at once, each a column of 3 #nodes numbers; replaced by the displacements.
  void solve_all(Eigen::Ref<Eigen::MatrixXd> columns) const;

  /// Lower bound of the condition: the square of the smallest over the largest diagonal entry of L.
  double rcond() const;
  const FactorCost& cost() const;
  const Symbolic& symbolic() const;

  /// Follows a change of K by sign times W W^T, in place and without a new elimination: `W` has three rows for each of
  /// `nodes`, which must be the nodes of one element; `sign` is +1 or -1. Cost: the columns from the first of them to
  /// the root, times the columns of W. Error `indefinite` leaves the factor unusable until refactor().
  Status update(const std::vector<int>& nodes, const Eigen::MatrixXd& W, int sign);

 private:
  struct Content;
  explicit Factor(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace face
