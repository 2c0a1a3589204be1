#include "manipulators/head_ik/control.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace head {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

// A gaze that cannot be had costs the roll before the direction. With much less weight the head would lean right over
// for the last few degrees, which people do not.
constexpr double roll_weight = 0.3;

// no head can look further round than this, and the wish for more would only tilt it
constexpr double widest = 100 * degree;

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

Matrix3d head_rotation(const Neck& neck, const Settings& settings, const Vector3d& posture) {
  return neck.rotation(posture) * settings.head_at_rest;
}

// linear over the tick; a normal goes along the chord
Sight between(const Sight& a, const Sight& b, double part) {
  Sight sight = b;
  sight.place = a.place + part * (b.place - a.place);
  const Vector3d chord = a.normal + part * (b.normal - a.normal);
  if (chord.norm() > 1e-6) sight.normal = chord.normalized();
  return sight;
}

}  // namespace

std::string_view name_of(Status status) {
  constexpr std::array<std::string_view, 6> names{"idle", "waiting", "moving", "reached", "limited", "too_near"};
  return names[static_cast<int>(status)];
}

Matrix3d paper_orientation(const Matrix3d& R) {
  Zyz angles = zyz(R, ZyzRule::paper);
  angles.beta = std::min(angles.beta, 61 * degree);
  return rotation(angles);
}

Vector3d eyes(const Neck& neck, const Settings& settings, const Vector3d& posture) {
  return neck.origin_of_head(posture) + head_rotation(neck, settings, posture) * settings.sight;
}

Matrix3d Control::wanted(const Settings& settings, const Vector3d& eye, const Sight& seen) {
  if (settings.part == Part::eyes) return donders(settings.wish, settings.roll);
  if (seen.kind == Sight::orientation) return facing(seen.normal, settings.roll);
  Gaze g = gaze(seen.place - eye);
  // who looks behind does not spin round with every small shift of the target
  if (std::abs(g.yaw) < M_PI - behind || state.side == 0) {
    state.side = g.yaw < 0 ? -1 : 1;
  } else if (state.side * g.yaw < 0) {
    g.yaw = state.side * M_PI;
  }
  if (settings.part == Part::human && settings.method == Method::swing_twist) g = head_part(g, settings.share);
  g.yaw = std::clamp(g.yaw, -widest, widest);
  return donders(g, settings.roll);
}

// a pure function of the target (and of the side it was last on), so that aiming twice is aiming once
void Control::aim(const Neck& neck, const Settings& settings, const Sight& seen, Report* report) {
  state.too_near = false;
  if (seen.kind == Sight::nothing && settings.part != Part::eyes) {
    state.goal.setZero();
    state.limit = Limit::none;
    return;
  }
  const bool by_place = seen.kind == Sight::point && settings.part != Part::eyes;
  Vector3d eye = eyes(neck, settings, Vector3d::Zero());
  Neck::Solution solution;
  // The eyes move with the head that they aim: a fixed point, contracting for a target beyond arm's length. The step is
  // relaxed by what the last one changed (Irons and Tuck 1969), which quickens the far targets and tames the near ones.
  Vector3d before(0, 0, 0);
  double relaxed = 1;
  for (int i = 0; i < 20; ++i) {
    if (by_place && (seen.place - eye).norm() < nearest) {
      state.too_near = true;
      return;
    }
    Matrix3d R = wanted(settings, eye, seen);
    if (settings.method == Method::paper_zyz) R = paper_orientation(R);
    solution = neck.solve(R * settings.head_at_rest.transpose(), by_place ? roll_weight : 1);
    report->iterations += solution.iterations;
    if (!by_place) break;
    const Vector3d off = eyes(neck, settings, solution.total) - eye;
    if (off.norm() < 1e-7) break;
    const Vector3d change = off - before;
    if (i > 0 && change.norm() > 0) relaxed *= -before.dot(change) / change.squaredNorm();
    relaxed = std::clamp(relaxed, 0.1, 2.0);
    before = off;
    eye += relaxed * off;
  }
  state.goal = solution.total;
  state.limit = solution.limit;
}

Control::Report Control::tick(const Neck& neck, const Settings& settings, double time, double step, const Sight& seen,
                              bool retargeted) {
  Report report;
  const double start = time - step;
  if (static_cast<double>(state.steps) * grid < start - grid)
    state.steps = static_cast<std::int64_t>(std::floor(start / grid + 1e-6));

  // a jump is answered after a while, motion at once
  const Matrix3d head = head_rotation(neck, settings, state.motion.posture());
  const Vector3d eye = eyes(neck, settings, state.motion.posture());
  const auto line = [&](const Sight& sight) -> Vector3d {
    if (sight.kind == Sight::orientation) return -sight.normal;
    return sight.kind == Sight::point ? Vector3d(sight.place - eye) : Vector3d(head.col(2));
  };
  const double shift = angle_between(line(state.seen), seen.kind == Sight::nothing ? Vector3d::UnitZ() : line(seen));
  const bool jumped = retargeted || seen.kind != state.seen.kind || shift > jump;
  if (jumped) {
    const double onset = start + settings.eye_latency + head_lag(shift);
    state.onset = state.onset < 0 ? onset : std::min(state.onset, onset);
  }
  const bool still = jumped || (seen.place == state.seen.place && seen.normal == state.seen.normal);

  for (bool aimed = false; static_cast<double>(state.steps + 1) * grid <= time + 1e-9;) {
    const double t = static_cast<double>(++state.steps) * grid;
    if (state.onset >= 0 && t >= state.onset) state.onset = -1;
    if (state.onset < 0 && !(still && aimed)) {
      aim(neck, settings, still ? seen : between(state.seen, seen, std::min(1.0, (t - start) / step)), &report);
      aimed = true;
    }
    advance(&state.motion, state.goal, settings.pace, grid);
  }
  state.seen = seen;

  // the tick may end between two points of the grid
  Motion motion = state.motion;
  const double rest = time - static_cast<double>(state.steps) * grid;
  if (rest > 1e-9) advance(&motion, state.goal, settings.pace, rest);

  report.posture = motion.posture();
  report.limit = state.limit;
  const Matrix3d now = head_rotation(neck, settings, report.posture);
  report.head_error = angle_between(now.col(2), head_rotation(neck, settings, state.goal).col(2));
  if (seen.kind == Sight::point)
    report.gaze_error = angle_between(now.col(2), seen.place - eyes(neck, settings, report.posture));
  if (seen.kind == Sight::orientation) report.gaze_error = angle_between(now.col(2), -seen.normal);

  const bool arrived = report.head_error < 0.1 * degree;
  if (state.onset >= 0)
    report.status = Status::waiting;
  else if (state.too_near)
    report.status = Status::too_near;
  else if (!arrived)
    report.status = Status::moving;
  else if (seen.kind == Sight::nothing)
    report.status = Status::idle;
  else
    report.status = state.limit == Limit::none ? Status::reached : Status::limited;
  return report;
}

}  // namespace head
