#pragma once

#include <Eigen/Core>
#include <array>

namespace head {

/// How fast a head moves. The defaults give a peak speed of 4 /s times the amplitude, as a linear system has it, until
/// `rate` bends it. That head speed is proportional to amplitude is measured (ten people, 10 to 50 degrees, r = 0.65:
/// Jibi to Rinsho 24 supplement 2, 559); the factor 4 and the 400 deg/s are from memory of the literature.
struct Pace {
  double lag = 0.0677;  ///< time constant of each of the three lags [s]; peak speed = 0.2707 / lag * amplitude
  double rate = 6.981317007977318;  ///< what a total may change in a second [rad/s]; 400 deg/s
};

/// Motion towards a goal, in the three totals of the neck: a limit of the rate, then three equal first-order lags.
///
/// Every state is a mean of goals that were, with weights that are positive and sum to 1. From that follows, for every
/// path of the goal and every step: the posture stays in the convex set the goals come from; no total moves faster than
/// `rate`; a step of the goal is answered without overshoot; position, speed and acceleration are continuous.
/// The lags are advanced exactly, so parts of a step compose to the whole.
struct Motion {
  Eigen::Vector3d paced{0, 0, 0};  ///< the goal as far as the rate allows
  std::array<Eigen::Vector3d, 3> lag{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};

  const Eigen::Vector3d& posture() const { return lag[2]; }
  /// d posture / dt [rad/s].
  Eigen::Vector3d speed(const Pace& pace) const { return (lag[1] - lag[2]) / pace.lag; }
};

/// One step of length h [s] with a goal that stays.
void advance(Motion* motion, const Eigen::Vector3d& goal, const Pace& pace, double h);

}  // namespace head
