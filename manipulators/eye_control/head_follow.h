#pragma once

#include <vector>

#include "manipulators/eye_control/parameters.h"
#include "manipulators/eye_control/world.h"

namespace eye {

/// The head's share of a target at `eccentricity` from straight ahead of it, rad: nothing below the threshold, then
/// `head_share` of the rest (end points of Freedman and Sparks 1997).
double head_share(double eccentricity, const Parameters& p);

/// How much later than the eyes the head starts, s: 139 ms for 10 deg, 50 ms for 40 deg, never negative (ten people).
double head_lag(double eccentricity);

/// A world whose head follows the eyes' large gaze shifts: the stand-in for a neck in simulations without one. Each
/// shift adds a minimum-jerk turn of `head_time`, so its peak speed is proportional to its size.
class FollowingWorld : public AngleWorld {
 public:
  using AngleWorld::AngleWorld;

  /// Look at a gaze that has just made a step; plans a head turn when a gaze shift has newly been decided.
  void follow(const Gaze& gaze);

  HeadPose head(double t) const override;

  /// Turn of the head on top of the given head track: Fick angles at time t, rad.
  Vec2 turned(double t) const;

 private:
  struct Turn {
    double start, duration;
    Vec2 size;
  };
  std::vector<Turn> turns_;
  Eigen::Vector3d followed_ = Eigen::Vector3d::Zero();  ///< the last target a turn was planned for, world
  int64_t known_onset_ = -1;
};

}  // namespace eye
