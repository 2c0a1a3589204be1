#pragma once

#include <vector>

#include "manipulators/eye_control/world.h"

namespace eye {

/// The world as a manipulator learns of it: target and head at the ends of ticks.
///
/// Between two ticks the head and a moving target go straight (the head along the shortest rotation). A target that
/// jumped between two ticks jumped at the earlier one, since that is when the command was said; which of the two it was
/// is judged when the next tick is known, early enough for eyes that see with a delay longer than a tick. A head cannot
/// wait for that, because its reflex is faster than a tick: what would take more than 10 000 deg/s^2 is a head that was
/// put there, and happens within a millisecond of the earlier tick.
class TickWorld : public World {
 public:
  TickWorld();

  /// The next tick: where head and target (m, world) are; `target` null: none. `switched`: it is not the target of the
  /// tick before, so it replaced that one at the earlier tick.
  void add(double time, const HeadPose& head, const Eigen::Vector3d* target, bool switched);

  /// Forget what lies more than `span` seconds before the last tick.
  void forget(double span);

  bool empty() const { return heads_.empty(); }
  double last() const { return heads_.back().time; }

  HeadPose head(double t) const override;
  bool target(double t, Track::Side side, const HeadPose& head, Sight& sight) const override;

  /// Everything as rows of numbers, and back; false if they do not fit.
  std::vector<double> save_heads() const;
  std::vector<double> save_targets() const;
  bool restore(const std::vector<double>& heads, const std::vector<double>& targets);

 private:
  bool jumped(double time, const HeadPose& head) const;

  struct Moment {
    double time;
    HeadPose pose;
  };
  Track target_;
  std::vector<Moment> heads_;
};

}  // namespace eye
