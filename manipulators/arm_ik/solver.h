#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "manipulators/arm_ik/descent.h"
#include "manipulators/arm_ik/outer_seeds.h"
#include "manipulators/arm_ik/seeds.h"
#include "manipulators/arm_ik/solution.h"
#include "manipulators/arm_ik/workspace.h"

namespace arm_ik {

/// Work is counted, not timed, so that the same call gives the same answer on every machine and under any load: a
/// budget in seconds buys budget / nominal_step_time(n) iterations.
struct SolveOptions {
  double position_tolerance = 1e-5;  ///< [m]
  double rotation_tolerance = 1e-4;  ///< [rad]
  double budget = 1e-3;              ///< [s] of nominal work
  std::uint64_t seed = 1;            ///< of the random starts after the tables are used up
  Isa isa = best_isa();
};

/// Time [s] of one iteration on an n-joint chain, measured on a 3.5 GHz core with four lanes.
double nominal_step_time(int joints);

/// Solves one chain with all its freedoms. Holds tables that are built on first need (two of 32768 postures, about
/// 30 ms each, the workspace and the postures at its edge, about 40 ms); not for two threads at once.
class Solver {
 public:
  explicit Solver(const kinematics::Chain& chain);

  const kinematics::Chain& chain() const { return chain_; }
  const Packed& packed() const { return packed_; }

  /// One descent from q (#joints, brought inside the limits). `status` reached, limited, unreachable or budget.
  Solution full(const Goal& goal, const SolveOptions& options, std::span<double> q) const;

  /// Starts from postures of the tables that put the tool near the goal, then from random ones, until one arrives, the
  /// goal shows itself out of reach, or the budget is spent. q: written only. The nearest posture found is the answer.
  /// A goal that is proven out of reach gets the nearest posture from a few starts at the edge of the workspace.
  Solution reach(const Goal& goal, const SolveOptions& options, std::span<double> q);

  /// full from q, then reach when that does not arrive.
  Solution full_then_reach(const Goal& goal, const SolveOptions& options, std::span<double> q);

  /// Another way to the goal: of the answers that some starts find, the one that the joints reach from q soonest.
  /// q (#joints): where they are, overwritten; unchanged when none is found, `status` then budget.
  Solution another_way(const Goal& goal, const SolveOptions& options, std::span<double> q);

  /// The sentence behind a status: distance left, what is proven to be left at least, what is beyond reach, which
  /// joints stand at which limit and hold.
  std::string reason(const Goal& goal, const Solution& solution, std::span<const double> q) const;

  /// Joints that stand at a limit of theirs and would go on through it to lower the error: index, +1 upper or -1 lower.
  struct ActiveLimit {
    int joint;
    int side;
  };
  std::vector<ActiveLimit> active_limits(const Goal& goal, std::span<const double> q) const;

  /// limited or unreachable, for a posture that no step brings nearer.
  Status status_of_nearest(const Goal& goal, std::span<const double> q) const;

  /// Builds the tables of `reach` now rather than on first need.
  void prepare();

  /// Is the goal farther from the chain's base than all links in a row?
  bool beyond_reach(const Goal& goal) const;

 private:
  const Workspace& workspace() const;

  kinematics::Chain chain_;
  Packed packed_;
  std::unique_ptr<SeedBank> inner_, edge_;
  std::unique_ptr<OuterSeeds> outer_;
  mutable std::unique_ptr<Workspace> workspace_;
};

}  // namespace arm_ik
