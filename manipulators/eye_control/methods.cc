#include "manipulators/eye_control/methods.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "manipulators/eye_control/crowd.h"
#include "manipulators/eye_control/head_follow.h"
#include "manipulators/eye_control/processor_time.h"
#include "manipulators/eye_control/simulate.h"
#include "manipulators/eye_control/tick_world.h"

namespace eye {

namespace {

constexpr MethodRow rows[] = {{Method::snap, 5.495 * deg, 148e-9},
                              {Method::saccade_only, 2.516 * deg, 292e-9},
                              {Method::linear, 0.543 * deg, 296e-9},
                              {Method::full, 0, 344e-9}};

constexpr double telling = 4e-6;  // of a figure in a tick: lines heard and told, a scene of 1000 figures, s
constexpr double length = 60;     // of the standard course, s

// what there is to be seen: every kind of motion a third of the time
FollowingWorld standard_course() {
  FollowingWorld world;
  for (int n = 0; n <= static_cast<int>(1000 * length); ++n) {
    const double t = n / 1000.0;
    double azimuth = 0, elevation = 0, near = 0, head = 0;
    if (t < 20) {
      // jumps of 4 to 30 deg
      const int k = static_cast<int>(t / 1.1);
      azimuth = 15 * std::sin(2.4 * k), elevation = 6 * std::sin(1.7 * k);
    } else if (t < 40) {
      azimuth = 8 * std::sin(2 * pi * 0.3 * t) + 3 * std::sin(2 * pi * 0.7 * t),
      elevation = 4 * std::cos(2 * pi * 0.4 * t);
    } else {
      // ramps of 12 deg/s there and back, near now and then, while the head turns
      const double saw = std::fmod(t, 2.5);
      azimuth = saw < 1.25 ? -7.5 + 12 * saw : 7.5 - 12 * (saw - 1.25);
      near = std::fmod(t, 6) < 2 ? 2 : 0;
      head = 10 * std::sin(2 * pi * 0.35 * (t - 40));
    }
    world.target_track().add(t, {azimuth * deg, elevation * deg, near});
    world.head_track().add(t, {head * deg, 0, 0});
  }
  return world;
}

Parameters with(Method method) {
  Parameters p;
  p.method = method;
  return p;
}

std::vector<Eigen::Vector3d> gazes(Method method) {
  FollowingWorld world = standard_course();
  std::vector<Eigen::Vector3d> directions;
  simulate(world, std::make_shared<Parameters>(with(method)), Frame::head,
           [&](const TraceRow&, const Gaze& gaze) { directions.push_back(gaze.eyes().left_direction); });
  return directions;
}

}  // namespace

std::span<const MethodRow> method_table() { return rows; }

const MethodRow& row_of(Method method) {
  return *std::find_if(std::begin(rows), std::end(rows), [&](const MethodRow& row) { return row.method == method; });
}

double measured_error(Method method) {
  const auto full = gazes(Method::full), other = gazes(method);
  double sum = 0;
  for (size_t k = 0; k < full.size(); ++k) {
    sum += std::pow(std::atan2(full[k].cross(other[k]).norm(), full[k].dot(other[k])), 2);
  }
  return std::sqrt(sum / static_cast<double>(full.size()));
}

double measured_cost(Method method) {
  constexpr int figures = 64, run = 180, rate = 60, settling = 30;
  // the course as a program meets it: target and head at the ends of ticks
  struct Moment {
    HeadPose head;
    Eigen::Vector3d target;
  };
  const FollowingWorld course = standard_course();
  std::vector<Moment> moments;
  for (int k = 0; k <= static_cast<int>(rate * length); ++k) {
    const double t = static_cast<double>(k) / rate;
    Moment moment{course.head(t), {}};
    Sight sight;
    course.target(t, Track::Side::right, moment.head, sight);
    moment.target = moment.head.orientation * sight.direction / std::max(sight.nearness, 0.3);
    moments.push_back(moment);
  }
  struct Figure {
    TickWorld world;
    Sighting sighting;
    Crowd::Seat seat;
  };
  const Parameters p = with(method);
  Crowd crowd;
  std::vector<Figure> all(figures);
  for (Figure& figure : all) {
    figure.seat = crowd.seat(p, 0, &figure);
    figure.seat.rest({}, 1);
  }
  const auto meet = [](void* who, const Crowd::Table& table, size_t lane) {
    Figure& figure = *static_cast<Figure*>(who);
    return stimulus(figure.world, table.parameters(), 0.063, table.step(), table.aim(lane), figure.sighting);
  };
  double start = 0;
  for (int tick = 0; tick < run; ++tick) {
    if (tick == settling) start = processor_time();
    const double time = static_cast<double>(tick) / rate;
    for (size_t k = 0; k < figures; ++k) {
      // each is elsewhere on the course
      const Moment& moment = moments[k * (moments.size() - run) / figures + static_cast<size_t>(tick)];
      all[k].world.add(time, moment.head, &moment.target, false);
      all[k].world.forget(0.3);
    }
    crowd.advance(static_cast<int64_t>(std::floor(time / p.step + 1e-6)), meet);
  }
  return (processor_time() - start) * rate * p.step / ((run - settling) * figures);
}

double tick_cost(Method method, double steps) { return telling + steps * row_of(method).cost; }

Method within_error(double error) {
  Method best = Method::full;
  for (const MethodRow& row : rows) {
    if (row.error <= error && row.cost < row_of(best).cost) best = row.method;
  }
  return best;
}

Method within_time(double time, size_t figures, double steps) {
  Method best = Method::snap;
  for (const MethodRow& row : rows) {
    if (tick_cost(row.method, steps) * static_cast<double>(figures) <= time && row.error < row_of(best).error)
      best = row.method;
  }
  return best;
}

}  // namespace eye
