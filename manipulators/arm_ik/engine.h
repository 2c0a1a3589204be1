#pragma once

#include "manipulators/arm_ik/solver.h"

namespace arm_ik {

/// All methods for one chain, by name.
class Engine {
 public:
  explicit Engine(const kinematics::Chain& chain);

  Solver& solver() { return solver_; }
  const kinematics::Chain& chain() const { return solver_.chain(); }

  /// Whether this chain can be solved by `method`; if not, `why_not` says what is missing.
  bool offers(Method method, std::string& why_not) const;

  /// Builds now what `method` would build on first need.
  void prepare(Method method);

  /// Solves from q (#joints; overwritten). automatic: the cheapest method that meets task and tolerance, a costlier one
  /// when it does not; `solution.method` tells which gave the answer.
  Solution solve(Method method, const Goal& goal, const SolveOptions& options, std::span<double> q);

 private:
  Solution automatic(const Goal& goal, const SolveOptions& options, std::span<double> q);
  Solution polish(const Goal& goal, const SolveOptions& options, std::span<double> q);

  Solver solver_;
};

}  // namespace arm_ik
