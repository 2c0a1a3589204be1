#include "manipulators/arm_ik/reacher.h"

#include <algorithm>
#include <cmath>

namespace arm_ik {

namespace {

// a goal that moves more than this in a tick has jumped
constexpr double jump_distance = 0.1;  // [m]
constexpr double jump_angle = 0.5;     // [rad]
// ticks without an answer before another way is looked for, and between two looks
constexpr int patience = 10, look_again = 60;
// peak of a least-jerk course over its mean speed
constexpr double peak = 1.875;
constexpr double towards_middle = 0.25;
// an aim this near [rad] is where the limb is
constexpr double there = 1e-9;

// share of the way at share s of the time, Flash and Hogan 1985
double least_jerk(double s) { return s * s * s * (10 + s * (6 * s - 15)); }

bool follows(Method method) { return method != Method::limb && method != Method::rhythm; }

}  // namespace

Reacher::Reacher(const kinematics::Chain& chain) : engine_(chain), tracker_(engine_.solver().packed()) {
  aim_.assign(chain.size(), 0.0);
  from_.assign(chain.size(), 0.0);
}

bool Reacher::jumped(const Order& order) const {
  const kinematics::Pose now = order.goal.target();
  if ((now.p - last_goal_.p).norm() > jump_distance) return true;
  return order.goal.pose && kinematics::rotation_distance(now.R, last_goal_.R) > jump_angle;
}

void Reacher::aim_anew(const Order& order, std::span<const double> q) {
  std::copy(q.begin(), q.begin() + static_cast<std::ptrdiff_t>(aim_.size()), aim_.begin());
  aim_solution_ = engine_.solve(order.method, order.goal, order.solve, aim_);
  set_out(order.rate, q);
}

// from q to the aim, from this tick on
void Reacher::set_out(double rate, std::span<const double> q) {
  from_.assign(q.begin(), q.begin() + static_cast<std::ptrdiff_t>(aim_.size()));
  double farthest = 0;
  for (std::size_t i = 0; i < aim_.size(); ++i) farthest = std::max(farthest, std::abs(aim_[i] - q[i]));
  elapsed_ = 0;
  duration_ = peak * farthest / rate;
  stuck_ = 0;
}

// what null space returns to: the posture in rhythm for a human arm; for any other chain rest, a little towards the
// middle of the ranges, because a posture at its limits leaves no room to move
void Reacher::posture_for(const Order& order, std::span<double> posture) const {
  const Packed& chain = engine_.solver().packed();
  for (int i = 0; i < chain.n; ++i)
    posture[i] = chain.rest[i] + towards_middle * (0.5 * (chain.lower[i] + chain.upper[i]) - chain.rest[i]);
  if (human()) engine_.natural_posture(order.goal, order.solve, posture);
}

void Reacher::follow(const Order& order, double dt) {
  if (!follows(order.method)) {
    aim_solution_ = engine_.solve(order.method, order.goal, order.solve, aim_);
    return;
  }
  double posture[Packed::capacity];
  posture_for(order, posture);
  TrackOptions how;
  how.position_tolerance = order.solve.position_tolerance;
  how.rotation_tolerance = order.solve.rotation_tolerance;
  how.rate = order.rate;
  how.isa = order.solve.isa;
  aim_solution_ = tracker_.follow(order.goal, how, posture, dt, aim_);
  stuck_ = aim_solution_.status == Status::reached ? 0 : stuck_ + 1;
}

Solution Reacher::tick(const Order& order, double dt, std::span<double> q) {
  const Solver& solver = engine_.solver();
  const Packed& chain = solver.packed();
  if (!active_ || order.fresh || jumped(order)) {
    aim_anew(order, q);
  } else {
    follow(order, dt);
  }
  active_ = true;
  last_goal_ = order.goal.target();
  if (stuck_ >= patience && (stuck_ - patience) % look_again == 0 && !solver.beyond_reach(order.goal)) {
    std::vector<double> other = aim_;
    const Solution found = engine_.another_way(order.goal, order.solve, other);
    if (found.status == Status::reached) {
      aim_ = other;
      aim_solution_ = found;
      set_out(order.rate, q);
    }
  }

  // along the course while one is under way, straight to the aim otherwise; never faster than the rate
  elapsed_ += dt;
  const bool travelling = duration_ > elapsed_;
  if (!travelling) duration_ = 0;
  const double share = travelling ? least_jerk(elapsed_ / duration_) : 1;
  double away = 0;
  for (int i = 0; i < chain.n; ++i) {
    const double next = from_[i] + share * (aim_[i] - from_[i]);
    const double cap = order.rate * dt;
    q[i] = std::clamp(share < 1 ? next : aim_[i], q[i] - cap, q[i] + cap);
    q[i] = std::clamp(q[i], chain.lower[i], chain.upper[i]);
    away = std::max(away, std::abs(aim_[i] - q[i]));
  }

  Solution out = aim_solution_;
  const kinematics::Pose at = kinematics::forward(solver.chain(), q);
  out.position_error = (last_goal_.p - at.p).norm();
  out.rotation_error = order.goal.pose ? kinematics::rotation_distance(last_goal_.R, at.R) : 0;
  const bool reached =
      out.position_error <= order.solve.position_tolerance && out.rotation_error <= order.solve.rotation_tolerance;
  if (reached) {
    out.status = Status::reached;
  } else if (away > there) {
    out.status = Status::moving;
  } else if (out.status != Status::budget) {
    out.status = solver.status_of_nearest(order.goal, q);
  }
  return out;
}

std::string Reacher::reason(const Goal& goal, const Solution& solution, std::span<const double> q) const {
  return engine_.solver().reason(goal, solution, q);
}

std::vector<double> Reacher::memory() const {
  std::vector<double> out = {static_cast<double>(active_),
                             static_cast<double>(aim_solution_.status),
                             static_cast<double>(aim_solution_.method),
                             static_cast<double>(aim_solution_.iterations),
                             elapsed_,
                             duration_,
                             static_cast<double>(stuck_)};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.push_back(last_goal_.R(row, column));
    out.push_back(last_goal_.p[row]);
  }
  out.insert(out.end(), aim_.begin(), aim_.end());
  out.insert(out.end(), from_.begin(), from_.end());
  return out;
}

bool Reacher::recall(std::span<const double> numbers) {
  constexpr std::size_t fixed = 7 + 12;
  if (numbers.size() != fixed + 2 * aim_.size()) return false;
  active_ = numbers[0] != 0;
  aim_solution_.status = static_cast<Status>(numbers[1]);
  aim_solution_.method = static_cast<Method>(numbers[2]);
  aim_solution_.iterations = static_cast<int>(numbers[3]);
  elapsed_ = numbers[4];
  duration_ = numbers[5];
  stuck_ = static_cast<int>(numbers[6]);
  for (int i = 0; i < 12; ++i) (i % 4 == 3 ? last_goal_.p[i / 4] : last_goal_.R(i / 4, i % 4)) = numbers[7 + i];
  std::copy_n(numbers.begin() + fixed, aim_.size(), aim_.begin());
  std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(fixed + aim_.size()), from_.size(), from_.begin());
  return true;
}

}  // namespace arm_ik
