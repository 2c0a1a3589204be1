#pragma once

#include <optional>
#include <string>
#include <vector>

#include "manipulators/arm_ik/engine.h"
#include "manipulators/arm_ik/tracker.h"

namespace arm_ik {

/// A limb that reaches through time: takes a goal every tick and moves the joints at bounded speed.
///
/// It keeps an aim, the posture that answers the goal. A new goal is solved once (by the method asked for) and the limb
/// travels there on a bell-shaped course in joint space (least jerk, Flash and Hogan 1985); from then on the aim
/// follows the goal without starting anew. When the way that it follows ends at a limit although the goal can be
/// reached, the nearest other way is found and travelled to.
class Reacher {
 public:
  explicit Reacher(const kinematics::Chain& chain);

  struct Order {
    explicit Order(const Goal& wanted) : goal(wanted) {}

    Goal goal;
    Method method = Method::automatic;
    SolveOptions solve;
    double rate = 6;     ///< the most that a joint moves [rad/s, m/s]
    bool fresh = false;  ///< another target than in the tick before
  };

  /// One tick of `dt` seconds. q (#joints): where the limb is, then where it will be. The errors are those of q; the
  /// method is the one that gave the aim.
  Solution tick(const Order& order, double dt, std::span<double> q);

  /// Why q is not at the goal; empty when it is.
  std::string reason(const Goal& goal, const Solution& solution, std::span<const double> q) const;
  /// Limits that hold the limb off its goal.
  std::vector<Solver::ActiveLimit> active_limits(const Goal& goal, std::span<const double> q) const {
    return engine_.solver().active_limits(goal, q);
  }
  bool offers(Method method, std::string& why_not) const { return engine_.offers(method, why_not); }
  const std::optional<HumanArm>& human() const { return engine_.human(); }
  const kinematics::Chain& chain() const { return engine_.chain(); }

  /// All that one tick leaves to the next, as numbers; the same numbers make the same future.
  std::vector<double> memory() const;
  /// Takes memory() back; false, and unchanged, when the numbers are not of this chain.
  bool recall(std::span<const double> numbers);

 private:
  void aim_anew(const Order& order, std::span<const double> q);
  void set_out(double rate, std::span<const double> q);
  void follow(const Order& order, double dt);
  void posture_for(const Order& order, std::span<double> posture) const;
  bool jumped(const Order& order) const;

  Engine engine_;
  Tracker tracker_;
  bool active_ = false;
  Solution aim_solution_;
  std::vector<double> aim_, from_;
  double elapsed_ = 0, duration_ = 0;  // of a travel; duration 0: none
  int stuck_ = 0;                      // ticks without an answer
  kinematics::Pose last_goal_;
};

}  // namespace arm_ik
