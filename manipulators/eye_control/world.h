#pragma once

#include <array>

#include "manipulators/eye_control/aim.h"
#include "manipulators/eye_control/gaze.h"
#include "manipulators/eye_control/track.h"

namespace eye {

/// The course of target and head that a pair of eyes lives in, as functions of time.
class World {
 public:
  virtual ~World() = default;

  /// The head at time t.
  virtual HeadPose head(double t) const = 0;

  /// The target of time t as seen from a head; false if there is none.
  virtual bool target(double t, Track::Side side, const HeadPose& head, Sight& sight) const = 0;
};

/// Turns what is seen into aims of one pair of eyes, remembering the last few: a target at rest, or the end of one step
/// that is the beginning of the next, costs no trigonometry. The answers do not depend on what is remembered.
class Sighting {
 public:
  Aim aim(const Sight& sight, double eye_distance, double range);

 private:
  struct Entry {
    Sight sight;
    double eye_distance = -1, range = 0;
    Aim aim;
  };
  std::array<Entry, 2> last_;
  size_t oldest_ = 0;
};

/// What a pair of eyes meets in its next internal step, from `step` on: the target as it was one visual delay ago, the
/// memory of it turned with the head, and the head's turn. `present`: where the eyes point.
Stimulus stimulus(const World& world, const Parameters& p, double eye_distance, int64_t step, const Aim& present,
                  Sighting& sighting);

/// The same of one pair alone.
inline Stimulus stimulus(const World& world, const Gaze& gaze) {
  Sighting sighting;
  return stimulus(world, gaze.parameters(), gaze.parameters().eye_distance, gaze.step(), gaze.aim(), sighting);
}

/// The eye turn (version) that keeps the present line of sight on its point in the world while the head goes from one
/// pose to the other, rad. The point lies where the eyes converge, so a moving head near it is compensated too.
Vec2 head_turn(const Aim& aim, const HeadPose& from, const HeadPose& to, double eye_distance);

/// Target and head given as Fick angles (rad) and nearness (1/m) in the world, right and up positive.
class AngleWorld : public World {
 public:
  /// Weight of (azimuth, elevation, nearness) as visual angles for telling jumps.
  explicit AngleWorld(double eye_distance = 0.063, double grid = 0.001)
      : target_(Track::Jump::on_arrival, {1, 1, eye_distance}, grid) {}

  Track& target_track() { return target_; }
  const Track& target_track() const { return target_; }
  Track& head_track() { return head_; }
  const Track& head_track() const { return head_; }

  HeadPose head(double t) const override;
  bool target(double t, Track::Side side, const HeadPose& head, Sight& sight) const override;

 private:
  Track target_, head_;
};

}  // namespace eye
