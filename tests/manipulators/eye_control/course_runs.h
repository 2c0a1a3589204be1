#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "manipulators/eye_control/head_follow.h"
#include "manipulators/eye_control/simulate.h"

/// Courses of targets and what a pair of eyes makes of them, for the tests.
namespace eye::test {

/// What is remembered of one run, one entry a step; angles in degrees, speeds in degrees a second.
struct Course {
  std::vector<double> t, position, elevation, velocity, command, vergence, vergence_rate, speed;
  std::vector<Mode> mode;
  std::vector<int64_t> saccades;

  size_t index(double time) const { return static_cast<size_t>(std::llround((time - t.front()) / (t[1] - t[0]))); }
};

inline Course run(FollowingWorld& world, const Parameters& parameters) {
  Course r;
  simulate(world, std::make_shared<Parameters>(parameters), Frame::head, [&](const TraceRow& row, const Gaze& gaze) {
    r.t.push_back(row.time);
    r.position.push_back(gaze.aim().version.x / deg);
    r.elevation.push_back(gaze.aim().version.y / deg);
    r.velocity.push_back(gaze.pursuit_velocity().x / deg);
    r.command.push_back(gaze.pursuit_command().x / deg);
    r.vergence.push_back(gaze.aim().vergence / deg);
    r.vergence_rate.push_back(gaze.vergence_rate() / deg);
    r.speed.push_back(std::abs(row.left_velocity) / deg);
    r.mode.push_back(row.mode);
    r.saccades.push_back(gaze.saccades());
  });
  return r;
}

/// One knot of a horizontal target: time s, azimuth deg.
struct At {
  double time, azimuth;
};

inline FollowingWorld world_of(const std::vector<At>& knots, double grid = 0.001) {
  FollowingWorld world(0.063, grid);
  for (const At& knot : knots) world.target_track().add(knot.time, {knot.azimuth * deg, 0, 0});
  return world;
}

inline Course follow(const std::vector<At>& knots, const Parameters& parameters) {
  FollowingWorld world = world_of(knots, parameters.step);
  return run(world, parameters);
}

/// A ramp of `speed` from 0 at t = 0, after 0.2 s of rest.
inline std::vector<At> ramp(double speed, double length) { return {{-0.2, 0}, {0, 0}, {length, speed * length}}; }

/// A smooth course sampled every millisecond.
inline std::vector<At> sampled(const std::function<double(double)>& azimuth, double from, double to) {
  std::vector<At> knots;
  for (int64_t k = std::llround(from * 1000); k <= std::llround(to * 1000); ++k) {
    knots.push_back({static_cast<double>(k) / 1000, azimuth(static_cast<double>(k) / 1000)});
  }
  return knots;
}

/// Gain and lag (s) of a velocity against speed * cos(2 pi f t), by least squares over [from, to]; `reference_peak` is
/// the target's peak velocity.
struct Response {
  double gain, lag;
};

inline Response response(const Course& r, const std::vector<double>& velocity, double frequency, double reference_peak,
                         double from, double to) {
  double c = 0, s = 0;
  size_t count = 0;
  for (size_t k = r.index(from); k < r.index(to); ++k) {
    const double phase = 2 * pi * frequency * r.t[k];
    c += velocity[k] * std::cos(phase);
    s += velocity[k] * std::sin(phase);
    ++count;
  }
  c *= 2.0 / static_cast<double>(count);
  s *= 2.0 / static_cast<double>(count);
  return {std::hypot(c, s) / reference_peak, std::atan2(s, c) / (2 * pi * frequency)};
}

/// Extremes of a response after `from`: values and times of successive local maxima and minima.
struct Extremes {
  std::vector<double> time, value;
};

inline Extremes extremes(const std::vector<double>& t, const std::vector<double>& x, double from, double least_change) {
  Extremes e;
  double reference = NAN;
  for (size_t k = 1; k + 1 < x.size(); ++k) {
    if (t[k] < from) continue;
    if ((x[k] - x[k - 1]) * (x[k + 1] - x[k]) > 0 || x[k] == x[k - 1]) continue;
    if (!std::isnan(reference) && std::abs(x[k] - reference) < least_change) continue;
    // a parabola through three points places the extreme between samples
    const double curve = x[k - 1] - 2 * x[k] + x[k + 1];
    const double shift = curve != 0 ? 0.5 * (x[k - 1] - x[k + 1]) / curve : 0;
    e.time.push_back(t[k] + shift * (t[k] - t[k - 1]));
    e.value.push_back(x[k]);
    reference = x[k];
  }
  return e;
}

}  // namespace eye::test
