#include "manipulators/arm_ik/solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

#include "manipulators/arm_ik/random.h"

namespace arm_ik {

namespace {

// measured: what helps one chain helps them all, see docs/arm.md
constexpr int inner_starts = 2;
constexpr int edge_starts = 64;
constexpr double edge_spill = 0.4;
constexpr double quick_patience = 0.8, long_patience = 0.95;
constexpr int steps_a_start = 50;
// descents that ended short before a goal is given up early, when all stay this share of the reach away
constexpr int enough_settled = 120;
constexpr double far_off = 0.1;
// out of reach there is nothing to hit: two whole descents come within 1 % of the best of a thousand in 97 of 100
constexpr int nearest_starts = 2;
constexpr double nearest_standstill = 1e-3;

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

void Solver::prepare() {
  if (!inner_) inner_ = std::make_unique<SeedBank>(packed_, SeedBank::default_count, 0, 1);
  if (!edge_) edge_ = std::make_unique<SeedBank>(packed_, SeedBank::default_count, edge_spill, 2);
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
  const bool beyond = beyond_reach(goal);

  Solution out;
  out.method = Method::reach;
  double least = HUGE_VAL, trial[Packed::capacity];
  int settled = 0;
  Random random(options.seed);
  DescentOptions how;
  how.position_tolerance = options.position_tolerance;
  how.rotation_tolerance = options.rotation_tolerance;
  how.patience = quick_patience;
  // one attempt; true when there is no need for another
  const auto attempt = [&] {
    how.iterations = std::min(steps_a_start, budget - out.iterations);
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
    if (out.iterations >= budget || (beyond && out.starts >= nearest_starts)) return true;
    return settled >= enough_settled && left > far_off;
  };

  SeedBank::Search inner(*inner_, goal);
  if (beyond) {
    how.patience = 1;
    how.standstill = nearest_standstill;
  }
  for (int k = 0; k < inner_starts; ++k) {
    const int index = inner.next();
    if (index < 0) break;
    inner_->posture(index, trial);
    if (attempt()) return out;
    if (spent()) break;
  }
  SeedBank::Search edge(*edge_, goal);
  for (int k = 0; k < edge_starts && !spent(); ++k) {
    const int index = edge.next();
    if (index < 0) break;
    edge_->posture(index, trial);
    if (attempt()) return out;
  }
  how.patience = long_patience;
  while (!spent()) {
    const std::uint64_t draw = random.next();
    const SeedBank& bank = draw & 1 ? *inner_ : *edge_;
    bank.posture(static_cast<int>((draw >> 2) % static_cast<std::uint64_t>(bank.size())), trial);
    // every other start lies between the best posture so far and one drawn anywhere
    if (draw & 2) {
      const double share = random.between(0, 0.5);
      for (int i = 0; i < packed_.n; ++i) trial[i] = q[i] + share * (trial[i] - q[i]);
    }
    if (attempt()) return out;
  }
  // so many ways that ended short of it say that there is none
  out.status = beyond || settled >= enough_settled ? status_of_nearest(goal, q) : Status::budget;
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

std::string Solver::reason(const Goal& goal, const Solution& solution, std::span<const double> q) const {
  if (solution.status == Status::reached) return {};
  std::ostringstream out;
  out.precision(3);
  out << solution.position_error << " m";
  if (goal.pose) out << " and " << solution.rotation_error << " rad";
  out << " left";
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
