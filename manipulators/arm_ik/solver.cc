#include "manipulators/arm_ik/solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <sstream>

#include "manipulators/arm_ik/random.h"

namespace arm_ik {

namespace {

// measured: what helps one chain helps them all, see docs/arm.md
constexpr int first_inner = 1, near_starts = 128;
constexpr double edge_spill = 0.8;
constexpr double patience = 0.8;
constexpr int steps_a_start = 50, steps_to_finish = 500;
// descents that ended short before a goal is given up early, when all stay this share of the reach away
constexpr int enough_settled = 120;
constexpr double far_off = 0.1;
// out of reach there is nothing to hit: three short descents come within 1 % of the best of a thousand in 99 of 100
constexpr int outer_starts = 3;
constexpr double outer_standstill = 1e-3;
// starts that look for another way
constexpr int ways = 24;
// starts that end short before the proof that there is no answer is looked for
constexpr int starts_before_proof = 1;

double clamp_to(const Packed& chain, int i, double q) { return std::clamp(q, chain.lower[i], chain.upper[i]); }

std::string metres(double length) {
  std::ostringstream out;
  out.precision(3);
  out << length << " m";
  return out.str();
}

}  // namespace

double nominal_step_time(int joints) { return 1e-7 + 2e-8 * joints; }

Solver::Solver(const kinematics::Chain& chain) : chain_(chain), packed_(chain) {}

bool Solver::beyond_reach(const Goal& goal) const { return (goal.target().p - chain_.base.p).norm() > packed_.reach; }

std::vector<Solver::ActiveLimit> Solver::active_limits(const Goal& goal, std::span<const double> q) const {
  const kinematics::Pose at = kinematics::forward(chain_, q), wanted = goal.target();
  const auto J = kinematics::jacobian(chain_, q);
  Eigen::Matrix<double, 6, 1> e = Eigen::Matrix<double, 6, 1>::Zero();
  e.head<3>() = wanted.p - at.p;
  if (goal.pose)
    e.tail<3>() = packed_.length * packed_.length * kinematics::rotation_vector(wanted.R * at.R.transpose());
  const Eigen::VectorXd pull = J.transpose() * e;
  std::vector<ActiveLimit> out;
  for (int i = 0; i < chain_.size(); ++i) {
    // a pull below rounding is none
    if (std::abs(pull[i]) < 1e-12) continue;
    if (q[i] >= packed_.upper[i] && pull[i] > 0) out.push_back({i, 1});
    if (q[i] <= packed_.lower[i] && pull[i] < 0) out.push_back({i, -1});
  }
  return out;
}

Status Solver::status_of_nearest(const Goal& goal, std::span<const double> q) const {
  if (beyond_reach(goal)) return Status::unreachable;
  return active_limits(goal, q).empty() ? Status::unreachable : Status::limited;
}

const Workspace& Solver::workspace() const {
  if (!workspace_) workspace_ = std::make_unique<Workspace>(packed_);
  return *workspace_;
}

void Solver::prepare() {
  if (!inner_) inner_ = std::make_unique<SeedBank>(packed_, SeedBank::default_count, 0, 1);
  if (!edge_) edge_ = std::make_unique<SeedBank>(packed_, SeedBank::default_count, edge_spill, 2);
  (void)workspace();
  if (!outer_) outer_ = std::make_unique<OuterSeeds>(packed_);
}

Solution Solver::full(const Goal& goal, const SolveOptions& options, std::span<double> q) const {
  assert(static_cast<int>(q.size()) >= packed_.n);
  for (int i = 0; i < packed_.n; ++i) q[i] = clamp_to(packed_, i, q[i]);
  DescentOptions how;
  how.position_tolerance = options.position_tolerance;
  how.rotation_tolerance = options.rotation_tolerance;
  how.iterations = std::max(1, static_cast<int>(std::min(1e6, options.budget / nominal_step_time(packed_.n))));
  const DescentResult found = descend(packed_, goal, how, q.data(), options.isa);
  Solution out;
  out.method = Method::full;
  out.position_error = found.position_error;
  out.rotation_error = found.rotation_error;
  out.iterations = found.iterations;
  out.starts = 1;
  out.status = found.reached ? Status::reached : found.stationary ? status_of_nearest(goal, q) : Status::budget;
  return out;
}

Solution Solver::reach(const Goal& goal, const SolveOptions& options, std::span<double> q) {
  assert(static_cast<int>(q.size()) >= packed_.n);
  prepare();
  const int budget = std::max(1, static_cast<int>(std::min(1e6, options.budget / nominal_step_time(packed_.n))));

  Solution out;
  out.method = Method::reach;
  double least = HUGE_VAL, trial[Packed::capacity];
  int settled = 0;
  Random random(options.seed);
  DescentOptions how;
  how.position_tolerance = options.position_tolerance;
  how.rotation_tolerance = options.rotation_tolerance;
  how.patience = patience;
  // one attempt; true when there is no need for another
  const auto attempt = [&](int most = steps_a_start) {
    how.iterations = std::min(most, budget - out.iterations);
    const DescentResult found = descend(packed_, goal, how, trial, options.isa);
    ++out.starts;
    out.iterations += found.iterations;
    if (found.stationary) ++settled;
    // the one that arrives is the answer even if another came nearer in place and missed in orientation
    if (found.reached || found.cost < least) {
      least = found.cost;
      std::copy_n(trial, packed_.n, q.begin());
      out.position_error = found.position_error;
      out.rotation_error = found.rotation_error;
    }
    if (found.reached) out.status = Status::reached;
    return found.reached;
  };
  const auto spent = [&] {
    const double left = std::sqrt(least) / packed_.reach;
    if (out.iterations >= budget) return true;
    return settled >= enough_settled && left > far_off;
  };

  const auto nearest_from_edge = [&] {
    int index[outer_starts];
    outer_->nearest(goal, outer_starts, index);
    how.patience = 1;
    how.standstill = outer_standstill;
    how.far = true;
    for (int k = 0; k < outer_starts && out.iterations < budget; ++k) {
      outer_->posture(index[k], trial);
      // cannot arrive, but for a tolerance that spans the gap
      if (attempt()) return;
    }
    out.status = status_of_nearest(goal, q);
  };
  if (workspace_->excludes_at_once(goal)) {
    nearest_from_edge();
    return out;
  }
  // the nearest of both tables by turns: some goals want their joints at limits, some will have none of it
  SeedBank::Search inner(*inner_, goal);
  std::optional<SeedBank::Search> edge;
  for (int k = 0; k < near_starts && !spent(); ++k) {
    const bool from_edge = k >= first_inner && (k - first_inner) % 2 == 0;
    if (from_edge && !edge) edge.emplace(*edge_, goal);
    const int index = from_edge ? edge->next() : inner.next();
    if (index < 0) continue;
    (from_edge ? *edge_ : *inner_).posture(index, trial);
    if (attempt()) return out;
    if (out.starts == starts_before_proof && workspace_->excludes(goal)) {
      nearest_from_edge();
      return out;
    }
  }
  // where the chain is stretched or folded the way to the goal itself is slow: the best so far is taken to its end
  if (!spent()) {
    std::copy_n(q.begin(), packed_.n, trial);
    how.patience = 1;
    if (attempt(steps_to_finish)) return out;
    how.patience = patience;
  }
  while (!spent()) {
    const std::uint64_t draw = random.next();
    const SeedBank& bank = draw & 1 ? *inner_ : *edge_;
    bank.posture(static_cast<int>((draw >> 1) % static_cast<std::uint64_t>(bank.size())), trial);
    if (attempt()) return out;
  }
  // so many ways that ended short of it say that there is none
  out.status = settled >= enough_settled ? status_of_nearest(goal, q) : Status::budget;
  return out;
}

Solution Solver::full_then_reach(const Goal& goal, const SolveOptions& options, std::span<double> q) {
  const Solution first = full(goal, options, q);
  if (first.status == Status::reached) return first;
  Solution second = reach(goal, options, q);
  second.iterations += first.iterations;
  second.starts += first.starts;
  return second;
}

Solution Solver::another_way(const Goal& goal, const SolveOptions& options, std::span<double> q) {
  prepare();
  Solution out;
  out.method = Method::reach;
  DescentOptions how;
  how.position_tolerance = options.position_tolerance;
  how.rotation_tolerance = options.rotation_tolerance;
  how.iterations = steps_a_start;
  how.patience = patience;
  SeedBank::Search inner(*inner_, goal), edge(*edge_, goal);
  double least = HUGE_VAL, trial[Packed::capacity], best[Packed::capacity];
  for (; out.starts < ways; ++out.starts) {
    const bool from_edge = out.starts % 2 == 1;
    const int index = from_edge ? edge.next() : inner.next();
    if (index < 0) continue;
    (from_edge ? *edge_ : *inner_).posture(index, trial);
    const DescentResult found = descend(packed_, goal, how, trial, options.isa);
    out.iterations += found.iterations;
    double farthest = 0;
    for (int i = 0; i < packed_.n; ++i) farthest = std::max(farthest, std::abs(trial[i] - q[i]));
    if (!found.reached || farthest >= least) continue;
    least = farthest;
    out.status = Status::reached;
    out.position_error = found.position_error;
    out.rotation_error = found.rotation_error;
    std::copy_n(trial, packed_.n, best);
  }
  if (out.status == Status::reached) std::copy_n(best, packed_.n, q.begin());
  return out;
}

std::string Solver::reason(const Goal& goal, const Solution& solution, std::span<const double> q) const {
  if (solution.status == Status::reached) return {};
  std::ostringstream out;
  out.precision(3);
  out << solution.position_error << " m";
  if (goal.pose) out << " and " << solution.rotation_error << " rad";
  out << " left";
  if (const double bound = workspace().distance_bound(goal); bound > 0)
    out << "; no posture comes nearer than " << metres(bound);
  const double distance = (goal.target().p - chain_.base.p).norm();
  if (distance > packed_.reach)
    out << "; target " << metres(distance) << " away, reach at most " << metres(packed_.reach);
  for (const ActiveLimit& limit : active_limits(goal, q)) {
    out << "; " << chain_.joints[limit.joint].name << " at its " << (limit.side > 0 ? "upper" : "lower") << " limit";
  }
  if (solution.status == Status::budget) out << "; the budget of work is spent";
  return out.str();
}

}  // namespace arm_ik
