#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "manipulators/head_ik/gaze.h"
#include "manipulators/head_ik/motion.h"
#include "manipulators/head_ik/neck.h"

namespace head {

/// What is looked at, in the neck's frame.
struct Sight {
  enum Kind { nothing, point, orientation } kind = nothing;
  Eigen::Vector3d place{0, 0, 0};   ///< of the target [m]
  Eigen::Vector3d normal{0, 0, 1};  ///< of its surface, for `orientation`
};

enum class Method { swing_twist, paper_zyz };
enum class Part { human, full, eyes };

/// What the scene sets.
struct Settings {
  Method method = Method::swing_twist;
  Part part = Part::human;
  Share share;
  Pace pace;
  double roll = 1;                                             ///< Donders: 1 Fick, 0 Listing
  double eye_latency = 0.2;                                    ///< from a new target to the eyes' start [s]
  Eigen::Vector3d sight{0, 0.03, 0.085};                       ///< between the eyes, in the head's frame [m]
  Eigen::Matrix3d head_at_rest = Eigen::Matrix3d::Identity();  ///< the head in the neck's frame at zero angles
  Gaze wish;                                                   ///< for Part::eyes
};

enum class Status { idle, waiting, moving, reached, limited, too_near };
std::string_view name_of(Status status);

/// The orientation (in the neck's frame, of a head whose own frame is the neck's at rest) that the paper's unit would
/// take: the angles as printed, each limited by itself. The paper gives no numbers for its limits; ours is 61 degrees
/// of beta and none of alpha and gamma, because any would forbid whole directions straight ahead, where only their sum
/// means something.
Eigen::Matrix3d paper_orientation(const Eigen::Matrix3d& R);

/// The head of one figure in time.
///
/// It lives on a grid of 1 ms that does not depend on the ticks: what it does between two grid points depends on the
/// target at these points only. A target that shifts by more than 3 degrees in a tick has jumped at the tick's start;
/// a smaller shift is motion, linear over the tick. After a jump the head waits for the eyes' latency and its own lag,
/// then follows the target wherever it is.
///
/// A target behind: the head stays on the side where it is until the target is 15 degrees past straight behind.
class Control {
 public:
  static constexpr double grid = 1e-3;                  ///< [s]
  static constexpr double jump = 0.05235987755982989;   ///< 3 deg
  static constexpr double behind = 0.2617993877991494;  ///< 15 deg
  static constexpr double nearest = 0.02;               ///< a target this close to the eyes has no direction [m]

  /// Everything that a checkpoint must hold.
  struct State {
    std::int64_t steps = 0;  ///< of the grid since time 0
    Motion motion;
    Eigen::Vector3d goal{0, 0, 0};
    double onset = -1;          ///< when a waiting head will start [s]; negative: it does not wait
    double side = 0;            ///< of the last target that was not behind: 1 left, -1 right
    Sight seen;                 ///< the target at the end of the last tick
    Limit limit = Limit::none;  ///< of the goal
    bool too_near = false;
  };

  /// What a tick ends with.
  struct Report {
    Status status = Status::idle;
    Limit limit = Limit::none;
    Eigen::Vector3d posture{0, 0, 0};  ///< totals at the end of the tick
    double gaze_error = 0;             ///< look axis to target, 0 without one [rad]
    double head_error = 0;             ///< look axis now to look axis at the goal [rad]
    int iterations = 0;                ///< Newton steps of all goals of this tick
  };

  State state;

  /// Advance to `time` from `time - step` [s], with what is seen at the end of the tick. `retargeted` says that it is
  /// something else than before, even if it stands near.
  Report tick(const Neck& neck, const Settings& settings, double time, double step, const Sight& seen, bool retargeted);

 private:
  void aim(const Neck& neck, const Settings& settings, const Sight& seen, Report* report);
  Eigen::Matrix3d wanted(const Settings& settings, const Eigen::Vector3d& eyes, const Sight& seen);
};

/// Where the point between the eyes is, in the neck's frame [m].
Eigen::Vector3d eyes(const Neck& neck, const Settings& settings, const Eigen::Vector3d& posture);

}  // namespace head
