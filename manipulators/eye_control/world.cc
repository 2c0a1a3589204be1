#include "manipulators/eye_control/world.h"

#include <algorithm>

namespace eye {

using Eigen::Vector3d;

Aim Sighting::aim(const Sight& sight, double eye_distance, double range) {
  for (const Entry& entry : last_) {
    if (entry.sight.direction == sight.direction && entry.sight.nearness == sight.nearness &&
        entry.eye_distance == eye_distance && entry.range == range) {
      return entry.aim;
    }
  }
  Entry& entry = last_[oldest_];
  oldest_ = 1 - oldest_;
  entry = {sight, eye_distance, range, aim_at(sight, eye_distance, range)};
  return entry.aim;
}

Stimulus stimulus(const World& world, const Parameters& p, double eye_distance, int64_t n, const Aim& present,
                  Sighting& sighting) {
  const auto time = [&](int64_t step) { return static_cast<double>(step) * p.step; };
  const auto aim = [&](double when, Track::Side side, const HeadPose& head, bool& visible) {
    Sight sight;
    visible = world.target(when, side, head, sight);
    return visible ? sighting.aim(sight, eye_distance, p.range) : Aim{};
  };
  Stimulus s;

  const HeadPose head = world.head(time(n)), head_next = world.head(time(n + 1));
  s.head_turn = head_turn(present, head, head_next, eye_distance);
  if (p.method == Method::snap) {
    s.present = aim(time(n + 1), Track::Side::right, head_next, s.present_visible);
    return s;
  }

  // the past: both ends of the step as the retina saw them
  const int64_t past = n - p.steps(p.visual_delay);
  bool from_visible = false, to_visible = false, goal_visible = false;
  const Aim from = aim(time(past), Track::Side::right, world.head(time(past)), from_visible);
  const Aim to = aim(time(past + 1), Track::Side::left, world.head(time(past + 1)), to_visible);
  s.visible = from_visible && to_visible;
  s.seen_from = from.version;
  s.seen_to = to.version;
  s.seen_vergence = 0.5 * (from.vergence + to.vergence);

  // the memory: the same target, seen from where the canals say that the head is now
  const HeadPose felt = world.head(time(n) - p.vor_latency);
  s.goal = aim(time(past), Track::Side::right, felt, goal_visible);
  if (!goal_visible) s.goal = {present.version, present.vergence, false};
  return s;
}

Vec2 head_turn(const Aim& aim, const HeadPose& from, const HeadPose& to, double eye_distance) {
  if (from.position == to.position && from.orientation.coeffs() == to.orientation.coeffs()) return {};
  const Vector3d direction = from.orientation * helmholtz_direction(aim.version);
  // eyes that converge look at a point, parallel ones in a direction
  const double nearness = eye_distance > 0 ? std::max(0.0, aim.vergence) / eye_distance : 0;
  const Vector3d shifted = direction - nearness * (to.position - from.position);
  return helmholtz_angles(to.orientation.conjugate() * shifted) - aim.version;
}

HeadPose AngleWorld::head(double t) const {
  if (head_.empty()) return {};
  const Vector3d angles = head_.at(t, Track::Side::right).value;
  HeadPose pose;
  pose.orientation = fick_rotation({angles.x(), angles.y()});
  return pose;
}

bool AngleWorld::target(double t, Track::Side side, const HeadPose& head, Sight& sight) const {
  const Track::Sample sample = target_.at(t, side);
  if (!sample.present) return false;
  sight =
      sight_of_direction(fick_direction({sample.value.x(), sample.value.y()}), std::max(0.0, sample.value.z()), head);
  return true;
}

}  // namespace eye
