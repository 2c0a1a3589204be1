#include "manipulators/flight/course.h"

#include <algorithm>
#include <cmath>

namespace flight {

using Eigen::Vector3d;

Course::Course(std::vector<Vector3d> points, std::vector<double> times) {
  if (points.empty()) return;
  if (points.size() != times.size()) {
    problem_ = "way has " + std::to_string(points.size()) + " points, times has " + std::to_string(times.size());
    return;
  }
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] <= times[i - 1]) {
      problem_ = "times do not rise at number " + std::to_string(i);
      return;
    }
  }
  problem_.clear();
  points_ = std::move(points);
  times_ = std::move(times);

  // second derivatives of the natural spline: a tridiagonal system, solved from the front (Thomas)
  const std::size_t n = points_.size();
  bend_.assign(n, Vector3d::Zero());
  std::vector<double> upper(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = times_[i] - times_[i - 1];
    const double after = times_[i + 1] - times_[i];
    const Vector3d right = 6 * ((points_[i + 1] - points_[i]) / after - (points_[i] - points_[i - 1]) / before);
    const double pivot = 2 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    bend_[i] = (right - before * bend_[i - 1]) / pivot;
  }
  for (std::size_t i = n; i-- > 1;) bend_[i - 1] -= upper[i - 1] * bend_[i];
}

Course::State Course::at(double time) const {
  State state;
  if (time <= start() || time >= end() || points_.size() == 1) {
    state.p = time <= start() ? points_.front() : points_.back();
    return state;
  }
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double h = times_[i + 1] - times_[i];
  const double u = (times_[i + 1] - time) / h;
  const double w = (time - times_[i]) / h;
  state.p =
      u * points_[i] + w * points_[i + 1] + h * h / 6 * ((u * u * u - u) * bend_[i] + (w * w * w - w) * bend_[i + 1]);
  state.v = (points_[i + 1] - points_[i]) / h + h / 6 * ((1 - 3 * u * u) * bend_[i] + (3 * w * w - 1) * bend_[i + 1]);
  state.a = u * bend_[i] + w * bend_[i + 1];
  return state;
}

Eigen::Quaterniond attitude(const Course::State& state, double lean, const Eigen::Quaterniond& before) {
  constexpr double gravity = 9.81;  // m/s2
  Vector3d forward = state.v;
  const bool flies = forward.norm() > 1e-3;
  // what stands still is level and looks where it looked
  if (!flies) forward = (before * Vector3d::UnitZ()).cwiseProduct(Vector3d(1, 0, 1));
  if (forward.norm() < 1e-6) forward = Vector3d::UnitZ();
  forward.normalize();
  const Vector3d level = Vector3d::UnitY().cross(forward);
  // straight up or down there is no level side
  if (level.norm() < 1e-3) return before;
  const Vector3d side = level.normalized();
  const Vector3d up = gravity * forward.cross(side) + lean * (flies ? side.dot(state.a) : 0.0) * side;
  Eigen::Matrix3d R;
  R.col(2) = forward;
  R.col(0) = up.cross(forward).normalized();
  R.col(1) = forward.cross(R.col(0));
  return Eigen::Quaterniond(R);
}

double wing_angle(double phase, double stroke, double climb) {
  // wings are held a little up when they glide
  constexpr double glide = 0.12;
  const double effort = std::clamp(0.45 + 0.5 * climb, 0.0, 1.0);
  return glide + stroke * effort * effort * (3 - 2 * effort) * std::sin(phase);
}

}  // namespace flight
