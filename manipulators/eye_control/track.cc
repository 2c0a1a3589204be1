#include "manipulators/eye_control/track.h"

#include <algorithm>
#include <cmath>

#include "manipulators/eye_control/vec2.h"

namespace eye {

using Eigen::Vector3d;

namespace {

constexpr double same_time = 1e-9;      // s
constexpr double visible = 0.05 * deg;  // smaller jumps are not worth the name, rad
constexpr double brief = 0.050;         // no motion is that short, s
constexpr double fast = 100 * deg;      // no pursuit is that fast, rad/s

Vector3d median(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return a.cwiseMin(b).cwiseMax(a.cwiseMax(b).cwiseMin(c));
}

}  // namespace

Track::Track(Jump jump, Vector3d weight, double grid) : jump_(jump), weight_(std::move(weight)), grid_(grid) {}

void Track::add(double time, const Vector3d& value, bool present) {
  knots_.push_back({time, value, value, value, present});
  const size_t last = knots_.size() - 1;
  if (last == 0) return;
  // the segment before can now be compared with what followed it
  if (last >= 2) judge(last - 1);
  judge(last);
}

// mean velocity of the segment that ends at knot `segment`; rest before the first
Vector3d Track::velocity(size_t segment) const {
  if (segment == 0 || segment >= knots_.size()) return Vector3d::Zero();
  const Knot &a = knots_[segment - 1], &b = knots_[segment];
  if (!a.present || !b.present || b.time - a.time < same_time) return Vector3d::Zero();
  return (b.value - a.value) / (b.time - a.time);
}

void Track::judge(size_t segment) {
  Knot &a = knots_[segment - 1], &b = knots_[segment];
  a.after = a.value;
  b.before = b.value;
  if (!a.present || !b.present) return;
  const double length = b.time - a.time;
  if (length < same_time) {
    b.before = a.value;
    return;
  }
  if (jump_ == Jump::never) return;

  const bool followed = segment + 1 < knots_.size();
  const Vector3d here = velocity(segment), change = b.value - a.value;
  const Vector3d motion = length * median(velocity(segment - 1), here, followed ? velocity(segment + 1) : here);
  const Vector3d rest = change - motion;
  const double size = rest.cwiseProduct(weight_).cwiseAbs().sum();
  const double all = change.cwiseProduct(weight_).cwiseAbs().sum();
  if (size < visible || size < 0.5 * all || size > 2 * all) return;
  if (length > brief && size < fast * length) return;

  // events are snapped to the grid of the fixed step, so that no step sees half a jump
  Knot& event = jump_ == Jump::on_arrival ? b : a;
  if (jump_ == Jump::on_arrival) {
    b.before = a.value + motion;
  } else {
    a.after = b.value - motion;
  }
  const double snapped = std::round(event.time / grid_) * grid_;
  const size_t index = jump_ == Jump::on_arrival ? segment : segment - 1;
  const bool in_order = (index == 0 || knots_[index - 1].time < snapped) &&
                        (index + 1 == knots_.size() || snapped < knots_[index + 1].time);
  if (in_order) event.time = snapped;
}

Track::Sample Track::at(double time, Side side) const {
  if (knots_.empty()) return {};
  const double t = side == Side::right ? time + same_time : time - same_time;
  // the first knot after t: the segment that ends there holds t
  const auto next =
      std::upper_bound(knots_.begin(), knots_.end(), t, [](double x, const Knot& k) { return x < k.time; });
  if (next == knots_.begin()) return {knots_.front().before, knots_.front().present};
  const Knot& from = *(next - 1);
  if (next == knots_.end()) return {from.after, from.present};
  const Knot& to = *next;
  if (!from.present) return {from.after, false};
  // towards an absence the last value holds, in finely sampled tracks the absence begins at once
  if (!to.present) return {from.after, to.time - from.time > brief};
  const double part = std::clamp((time - from.time) / (to.time - from.time), 0.0, 1.0);
  return {from.after + part * (to.before - from.after), true};
}

void Track::forget_before(double time) {
  size_t keep = 0;
  while (keep + 2 < knots_.size() && knots_[keep + 2].time <= time) ++keep;
  knots_.erase(knots_.begin(), knots_.begin() + static_cast<std::ptrdiff_t>(keep));
}

}  // namespace eye
