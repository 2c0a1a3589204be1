#pragma once

#include <optional>

#include "manipulators/arm_ik/human_arm.h"
#include "manipulators/arm_ik/solver.h"

namespace arm_ik {

/// All methods for one chain, by name.
class Engine {
 public:
  explicit Engine(const kinematics::Chain& chain);

  const Solver& solver() const { return solver_; }
  /// The chain as a human arm, if it is one.
  const std::optional<HumanArm>& human() const { return human_; }
  const kinematics::Chain& chain() const { return solver_.chain(); }

  /// Whether this chain can be solved by `method`; if not, `why_not` says what is missing.
  bool offers(Method method, std::string& why_not) const;

  /// Builds now what `method` would build on first need.
  void prepare(Method method);

  /// Solves from q (#joints; overwritten). automatic: the cheapest method that meets task and tolerance, a costlier one
  /// when it does not; `solution.method` tells which gave the answer.
  Solution solve(Method method, const Goal& goal, const SolveOptions& options, std::span<double> q);

  /// See Solver::another_way.
  Solution another_way(const Goal& goal, const SolveOptions& options, std::span<double> q) {
    return solver_.another_way(goal, options, q);
  }

  /// The posture in scapulohumeral rhythm that puts a human arm's wrist at the goal, as nearly as its limits allow.
  /// Requires human().
  void natural_posture(const Goal& goal, const SolveOptions& options, std::span<double> posture) const;

 private:
  Solution automatic(const Goal& goal, const SolveOptions& options, std::span<double> q);
  Solution polish(const Goal& goal, const SolveOptions& options, std::span<double> q);

  Solver solver_;
  std::optional<HumanArm> human_;
};

}  // namespace arm_ik
