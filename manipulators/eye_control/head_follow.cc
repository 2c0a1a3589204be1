#include "manipulators/eye_control/head_follow.h"

#include <algorithm>
#include <cmath>

#include "manipulators/eye_control/course.h"

namespace eye {

namespace {

constexpr double same_place = 0.996;  // cosine of 5 deg

}  // namespace

double head_share(double eccentricity, const Parameters& p) {
  return p.head_share * std::max(0.0, eccentricity - p.head_threshold);
}

double head_lag(double eccentricity) { return std::clamp(0.139 - 0.003 * (eccentricity / deg - 10), 0.0, 0.140); }

Vec2 FollowingWorld::turned(double t) const {
  Vec2 sum;
  for (const Turn& turn : turns_) sum += course((t - turn.start) / turn.duration) * turn.size;
  return sum;
}

HeadPose FollowingWorld::head(double t) const {
  if (turns_.empty()) return AngleWorld::head(t);
  Vec2 angles = turned(t);
  if (!head_track().empty()) {
    const Eigen::Vector3d given = head_track().at(t, Track::Side::right).value;
    angles += Vec2{given.x(), given.y()};
  }
  HeadPose pose;
  pose.orientation = fick_rotation(angles);
  return pose;
}

void FollowingWorld::follow(const Gaze& gaze) {
  if (!gaze.preparing() || gaze.onset() == known_onset_) return;
  known_onset_ = gaze.onset();

  // where the target will be relative to the head once all turns that are under way have ended
  const Parameters& p = gaze.parameters();
  const double now = static_cast<double>(gaze.step()) * p.step, ended = 1e9;
  Sight sight;
  const HeadPose rest = head(ended);
  if (!target(now - p.visual_delay, Track::Side::right, rest, sight)) return;
  // the eyes' corrections on the way are no new gaze shift
  const Eigen::Vector3d place = rest.orientation * sight.direction;
  if (place.dot(followed_) > same_place) return;
  followed_ = place;
  const Vec2 angles = fick_angles(sight.direction);
  const double eccentricity = std::acos(std::clamp(sight.direction.z(), -1.0, 1.0));
  const double share = head_share(eccentricity, p);
  if (share < 1e-3) return;
  const double start = static_cast<double>(gaze.onset()) * p.step + head_lag(eccentricity);
  turns_.push_back({start, p.head_time, (share / eccentricity) * angles});
}

}  // namespace eye
