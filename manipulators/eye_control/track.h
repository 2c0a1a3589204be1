#pragma once

#include <vector>

#include <Eigen/Core>

namespace eye {

/// A signal of three components known at moments: straight lines between them, except where it jumps or is absent.
///
/// A jump is told from motion by its neighbours: the motion within a segment is the median of its velocity and those of
/// the segments before and after, component by component, and the rest is a jump if it is most of the change, is
/// visible at all, and is too short (50 ms) or too fast (100 deg/s) to be followed. So a step that is sampled finely
/// stays a step, a step onto a moving target keeps both, and the start or end of a ramp is no jump. Two moments with
/// the same time are a jump in any case. The last segment is judged again when the next moment is known.
class Track {
 public:
  /// Where in its segment a jump happens: samples show it on arrival; a command between two ticks acts at once.
  enum class Jump { on_arrival, on_departure, never };

  /// `angle` weighs a change of the three components as a visual angle, rad: |change * weight| summed.
  /// Jumps are moved to the nearest multiple of `grid`, s.
  explicit Track(Jump jump = Jump::never, Eigen::Vector3d weight = Eigen::Vector3d::Ones(), double grid = 0.001);

  /// The next moment; times must not fall. `present` false: nothing from here on.
  void add(double time, const Eigen::Vector3d& value, bool present = true);

  /// Limits at time t: from the left (what was just before) or from the right (what is from now on).
  enum class Side { left, right };
  struct Sample {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    bool present = false;
  };
  Sample at(double time, Side side) const;

  /// Forget all but what is needed from `time` on.
  void forget_before(double time);

  void set_weight(const Eigen::Vector3d& weight) { weight_ = weight; }
  bool empty() const { return knots_.empty(); }
  double first() const { return knots_.front().time; }
  double last() const { return knots_.back().time; }

  /// One moment as stored: raw value and the limits that the judgement gave.
  struct Knot {
    double time = 0;
    Eigen::Vector3d value, before, after;
    bool present = true;
  };
  const std::vector<Knot>& knots() const { return knots_; }
  void set_knots(std::vector<Knot> knots) { knots_ = std::move(knots); }

 private:
  Eigen::Vector3d velocity(size_t segment) const;
  void judge(size_t segment);

  Jump jump_;
  Eigen::Vector3d weight_;
  double grid_;
  std::vector<Knot> knots_;
};

}  // namespace eye
