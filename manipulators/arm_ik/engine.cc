#include "manipulators/arm_ik/engine.h"

#include <algorithm>

#include "manipulators/arm_ik/clamped.h"
#include "manipulators/arm_ik/coupled.h"
#include "manipulators/arm_ik/limb.h"

namespace arm_ik {

namespace {

// joint speed [rad a step] of the slow reference
constexpr double clamped_rate = 0.1;

}  // namespace

Engine::Engine(const kinematics::Chain& chain) : solver_(chain), human_(HumanArm::recognize(chain)) {}

bool Engine::offers(Method method, std::string& why_not) const {
  if ((method != Method::limb && method != Method::rhythm) || human_) return true;
  why_not = "needs the eleven-freedom human arm";
  return false;
}

void Engine::prepare(Method method) {
  if (method != Method::full && method != Method::clamped) solver_.prepare();
}

Solution Engine::solve(Method method, const Goal& goal, const SolveOptions& options, std::span<double> q) {
  switch (method) {
    case Method::full: return solver_.full(goal, options, q);
    case Method::reach: return solver_.reach(goal, options, q);
    case Method::polish: return polish(goal, options, q);
    case Method::clamped: return clamped_least_squares(solver_, goal, options, clamped_rate, q);
    case Method::limb:
      if (human_) return solve_limb(*human_, goal, options, true, q);
      break;
    case Method::rhythm:
      if (human_) return solve_coupled(*human_, goal, options, q);
      break;
    case Method::automatic: break;
  }
  return automatic(goal, options, q);
}

void Engine::natural_posture(const Goal& goal, const SolveOptions& options, std::span<double> posture) const {
  solve_limb(*human_, goal, options, true, posture);
}

// closed form for a place, all freedoms for a pose, many starts when one does not arrive
Solution Engine::automatic(const Goal& goal, const SolveOptions& options, std::span<double> q) {
  int spent = 0;
  if (human_ && !goal.pose) {
    double trial[HumanArm::joints];
    std::copy_n(q.begin(), HumanArm::joints, trial);
    const Solution limb = solve_limb(*human_, goal, options, true, trial);
    spent = limb.iterations;
    // even where limits stop it this is the natural place to go on from
    std::copy_n(trial, HumanArm::joints, q.begin());
    if (limb.status == Status::reached) return limb;
  }
  Solution out = solver_.full_then_reach(goal, options, q);
  out.iterations += spent;
  return out;
}

Solution Engine::polish(const Goal& goal, const SolveOptions& options, std::span<double> q) {
  // from so near that rounding is all that can stop the way down
  SolveOptions near = options;
  near.position_tolerance = std::min(options.position_tolerance, 1e-8);
  near.rotation_tolerance = std::min(options.rotation_tolerance, 1e-7);
  Solution out = solver_.full_then_reach(goal, near, q);
  out.method = Method::polish;
  if (out.status != Status::reached) return out;
  // no tolerance is small enough: the descent ends when rounding lets no step lower the error
  SolveOptions exact = options;
  exact.position_tolerance = exact.rotation_tolerance = 0;
  const Solution last = solver_.full(goal, exact, q);
  out.position_error = last.position_error;
  out.rotation_error = last.rotation_error;
  out.iterations += last.iterations;
  return out;
}

}  // namespace arm_ik
