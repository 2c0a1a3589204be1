#include "manipulators/eye_control/restless.h"

#include <algorithm>
#include <cmath>

#include "manipulators/eye_control/course.h"
#include "manipulators/eye_control/random.h"

namespace eye {

namespace {

constexpr double largest = 0.95 * deg;  // of microsaccades, rad
constexpr double pause = 1.0;           // between blinks at least, s

}  // namespace

Restless::Restless(const Parameters& p, uint64_t seed) : p_(&p), h_(p.step), seed_(seed) {}

Vec2 Restless::drift(int64_t n) {
  if (p_->drift_speed == 0) return {};
  const double keep = std::exp(-h_ / p_->drift_time);
  const double kick = p_->drift_speed * std::sqrt(1 - keep * keep);
  const auto count = static_cast<uint64_t>(n);
  drift_ =
      keep * drift_ + kick * Vec2{normal(seed_, Stream::drift, 2 * count), normal(seed_, Stream::drift, 2 * count + 1)};
  return h_ * drift_;
}

bool Restless::microsaccade(int64_t n, Vec2 error, Vec2& displacement) const {
  if (p_->microsaccade_rate == 0) return false;
  const auto count = 4 * static_cast<uint64_t>(n);
  if (uniform(seed_, Stream::microsaccade, count) >= p_->microsaccade_rate * h_) return false;
  const double size =
      std::min(largest, p_->microsaccade_size * std::exp(0.4 * normal(seed_, Stream::microsaccade, count / 2 + 1)));
  const double angle = 2 * pi * uniform(seed_, Stream::microsaccade, count + 1);
  const double off = norm(error);
  // half of the way home, half at random
  const Vec2 home = off > 1e-9 ? (0.5 * size / off) * error : Vec2{};
  displacement = home + (0.5 * size) * Vec2{std::cos(angle), std::sin(angle)};
  return norm(displacement) > 1e-5;
}

double Restless::lid(int64_t n) {
  if (blink_from_ < 0) {
    const bool begins = p_->blink_rate > 0 && n >= quiet_until_ &&
                        uniform(seed_, Stream::blink, static_cast<uint64_t>(n)) <
                            h_ * p_->blink_rate / std::max(1e-3, 1 - p_->blink_rate * pause);
    if (!begins) return 0;
    blink_from_ = n;
  }
  const double t = static_cast<double>(n + 1 - blink_from_) * h_;
  if (t >= p_->blink_closing + p_->blink_opening) {
    blink_from_ = -1;
    quiet_until_ = n + static_cast<int64_t>(pause / h_);
    return 0;
  }
  if (t <= p_->blink_closing) return p_->blink_depth * course(t / p_->blink_closing);
  return p_->blink_depth * (1 - course((t - p_->blink_closing) / p_->blink_opening));
}

}  // namespace eye
