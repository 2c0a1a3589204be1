#include "manipulators/eye_control/tick_world.h"

#include <algorithm>

namespace eye {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double step = 0.001;                     // a put head moves within one internal step, s
constexpr double most_acceleration = 10000 * deg;  // of heads, rad/s^2; impulses by hand reach 7100 deg/s^2
constexpr size_t head_numbers = 8, knot_numbers = 11;

}  // namespace

TickWorld::TickWorld() : target_(Track::Jump::on_departure) {}

void TickWorld::add(double time, const HeadPose& head, const Vector3d* target, bool switched) {
  // a change counts by the angle under which it is seen
  const Vector3d place = target ? *target : Vector3d::Zero();
  const double distance = target ? std::max(0.05, (place - head.position).norm()) : 1;
  target_.set_weight(Vector3d::Constant(1 / distance));
  if (switched && !heads_.empty()) target_.add(heads_.back().time, place, target != nullptr);
  target_.add(time, place, target != nullptr);
  if (!heads_.empty() && heads_.back().time + step < time && jumped(time, head)) {
    heads_.push_back({heads_.back().time + step, head});
  }
  heads_.push_back({time, head});
}

// no head turns that suddenly: it was put there
bool TickWorld::jumped(double time, const HeadPose& head) const {
  const Moment& last = heads_.back();
  const double length = time - last.time;
  const auto turn = [](const HeadPose& a, const HeadPose& b) {
    const Eigen::AngleAxisd turned(b.orientation * a.orientation.conjugate());
    return Vector3d(turned.angle() * turned.axis());
  };
  Vector3d expected = Vector3d::Zero();
  if (heads_.size() >= 2) {
    const Moment& before = heads_[heads_.size() - 2];
    expected = length / (last.time - before.time) * turn(before.pose, last.pose);
  }
  return (turn(last.pose, head) - expected).norm() > most_acceleration * length * length;
}

void TickWorld::forget(double span) {
  const double from = heads_.back().time - span;
  size_t keep = 0;
  while (keep + 2 < heads_.size() && heads_[keep + 2].time <= from) ++keep;
  heads_.erase(heads_.begin(), heads_.begin() + static_cast<std::ptrdiff_t>(keep));
  target_.forget_before(from);
}

HeadPose TickWorld::head(double t) const {
  const auto next =
      std::upper_bound(heads_.begin(), heads_.end(), t, [](double x, const Moment& m) { return x < m.time; });
  if (next == heads_.begin()) return heads_.front().pose;
  const Moment& from = *(next - 1);
  if (next == heads_.end()) return from.pose;
  const HeadPose &a = from.pose, &b = next->pose;
  // a head at rest stays at rest to the last bit
  if (a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs()) return a;
  const double part = (t - from.time) / (next->time - from.time);
  return {a.position + part * (b.position - a.position), a.orientation.slerp(part, b.orientation)};
}

bool TickWorld::target(double t, Track::Side side, const HeadPose& head, Sight& sight) const {
  const Track::Sample sample = target_.at(t, side);
  if (!sample.present) return false;
  sight = sight_of_point(sample.value, head);
  return true;
}

std::vector<double> TickWorld::save_heads() const {
  std::vector<double> numbers;
  for (const Moment& m : heads_) {
    const auto& p = m.pose.position;
    const auto& q = m.pose.orientation;
    numbers.insert(numbers.end(), {m.time, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
  }
  return numbers;
}

std::vector<double> TickWorld::save_targets() const {
  std::vector<double> numbers;
  for (const Track::Knot& k : target_.knots()) {
    numbers.push_back(k.time);
    for (const Vector3d* v : {&k.value, &k.before, &k.after}) numbers.insert(numbers.end(), {v->x(), v->y(), v->z()});
    numbers.push_back(static_cast<double>(k.present));
  }
  return numbers;
}

bool TickWorld::restore(const std::vector<double>& heads, const std::vector<double>& targets) {
  if (heads.empty() || heads.size() % head_numbers != 0 || targets.size() % knot_numbers != 0) return false;
  heads_.clear();
  for (size_t k = 0; k < heads.size(); k += head_numbers) {
    const double* x = &heads[k];
    heads_.push_back({x[0], {Vector3d(x[1], x[2], x[3]), Quaterniond(x[4], x[5], x[6], x[7])}});
  }
  std::vector<Track::Knot> knots;
  for (size_t k = 0; k < targets.size(); k += knot_numbers) {
    const double* x = &targets[k];
    knots.push_back({x[0], {x[1], x[2], x[3]}, {x[4], x[5], x[6]}, {x[7], x[8], x[9]}, x[10] != 0});
  }
  target_.set_knots(std::move(knots));
  return true;
}

}  // namespace eye
