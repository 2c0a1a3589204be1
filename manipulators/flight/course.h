#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace flight {

/// A way through points at given times: the natural cubic spline, so place, velocity and acceleration are continuous.
class Course {
 public:
  /// Where it is, how fast and how its velocity changes [m, m/s, m/s2].
  struct State {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    Eigen::Vector3d a = Eigen::Vector3d::Zero();
  };

  Course() = default;
  /// `points` at `times` [s], as many of each, times rising; one point is a place to stay at. Otherwise the course is
  /// empty and problem() says why.
  Course(std::vector<Eigen::Vector3d> points, std::vector<double> times);

  bool empty() const { return points_.empty(); }
  const std::string& problem() const { return problem_; }
  double start() const { return times_.front(); }
  double end() const { return times_.back(); }
  /// At `time`; before the start and after the end it stands still where it starts and ends.
  State at(double time) const;

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> times_;
  std::vector<Eigen::Vector3d> bend_;  ///< accelerations at the points [m/s2]
  std::string problem_ = "way has no points";
};

/// The attitude of something that flies like that in a coordinated turn: its +Z along the velocity, its +Y against the
/// pull that it feels, `lean` times the sideways one of the turn. Without speed: level, +Z as in `before`.
Eigen::Quaterniond attitude(const Course::State& state, double lean, const Eigen::Quaterniond& before);

/// Angle of a wing above level [rad] at a phase of its beat [rad], for a climb of `climb` m/s: it beats the more the
/// steeper it climbs, and glides when it sinks.
double wing_angle(double phase, double stroke, double climb);

}  // namespace flight
