#include "manipulators/eye_control/pursuit.h"

namespace eye {

namespace {

constexpr double blank_time = 0.1;        // how long a hidden target is taken to go on as before, s
constexpr double attributed = 0.1;        // share of head speed that is taken for a fault of the reflex
constexpr double attribution = 0.1;       // and for how long after, s
constexpr double trusted = 0.1;           // trust from which a forecast alone keeps pursuit on
constexpr double inversion_limit = 0.95;  // share of the acceleration limit that a forecast may ask for

}  // namespace

Pursuit::Pursuit(const Parameters& p)
    : p_(&p),
      h_(p.step),
      visual_(p.steps(p.visual_delay)),
      copy_visual_(p.steps(p.copy_visual_delay)),
      local_(p.steps(p.local_delay)),
      motor_(p.steps(p.motor_delay)),
      copy_motor_(p.steps(p.copy_motor_delay)),
      hold_(static_cast<int>(std::lround(p.offset_hold / p.step))),
      blank_(p.steps(blank_time)),
      linear_(p.method == Method::linear),
      switched_(p.offset_switch >= 0.5 && !linear_),
      plant_(p.plant_time, p.step),
      copy_plant_(p.copy_plant_time, p.step),
      sight_(p.visual_lag, p.step),
      fade_(std::exp(-p.step / p.offset_time)),
      forget_(std::exp(-p.step / attribution)),
      horizontal_(p),
      vertical_(p) {
  span_ = std::max({visual_, copy_visual_, local_, motor_, copy_motor_});
  predicting_ = p.predictor >= 0.5 && !linear_ && p.visual_delay + p.motor_delay + p.visual_lag < horizontal_.horizon();
}

// soft limit of acceleration: direction kept, size x / (1 + x / limit)
Vec2 Pursuit::saturated(Vec2 error) const {
  const Vec2 wanted = p_->local_gain * error;
  return linear_ ? wanted : (1 / (1 + norm(wanted) / p_->acceleration_limit)) * wanted;
}

// the premotor input `ahead` of the last seen step: what is seen, as far as the forecast is not trusted
Vec2 Pursuit::drive(Vec2 seen, Vec2 error, double ahead) const {
  if (linear_) return p_->pursuit_gain * seen;
  const double speed2 = dot(seen, seen), limit = p_->velocity_limit;
  const double share = speed2 > limit * limit ? limit / std::sqrt(speed2) : 1;
  const Vec2 reactive = p_->pursuit_gain * share * seen;
  const double tx = horizontal_.trust(), ty = vertical_.trust();
  if (!predicting_ || (tx == 0 && ty == 0)) return reactive;

  // inverse of loop and plant: command q(t) = T(t + to) + T2 T'(t + to) makes the eye's velocity T(t);
  // the loop follows q when fed q(t - tm) + AS^-1(q') / K
  const double horizon = p_->visual_delay + p_->visual_lag + p_->motor_delay + ahead;
  const auto x = horizontal_.ahead(horizon), y = vertical_.ahead(horizon);
  const auto x_before = horizontal_.ahead(horizon - p_->local_delay),
             y_before = vertical_.ahead(horizon - p_->local_delay);
  const Vec2 before{x_before.value + p_->plant_time * x_before.rate, y_before.value + p_->plant_time * y_before.rate};
  Vec2 rate{x.rate + p_->plant_time * x.curvature, y.rate + p_->plant_time * y.curvature};
  const double most = inversion_limit * p_->acceleration_limit, size = norm(rate);
  if (size > most) rate = (most / size) * rate;
  const double gain = p_->local_gain * (1 - norm(rate) / p_->acceleration_limit);
  const Vec2 forecast = before + (1 / gain) * rate + p_->position_rate * error;
  return {reactive.x + tx * (forecast.x - reactive.x), reactive.y + ty * (forecast.y - reactive.y)};
}

// pursuit starts and ends as a whole; fixation is not pursuit of a target at rest, and what is seen to move while the
// head turns is put down to the reflex as far as that may be
void Pursuit::switch_over(double head_speed) {
  head_speed_ = std::max(head_speed, forget_ * head_speed_);
  const double reflex = attributed * head_speed_, on = p_->pursuit_on + reflex, off = p_->pursuit_off + reflex;
  const double speed2 = dot(seen_, seen_);
  still_ = speed2 < off * off ? still_ + 1 : 0;
  const Vec2 trust = predicting_ ? this->trust() : Vec2{};
  const bool expected = std::max(trust.x, trust.y) > trusted;
  if (speed2 > on * on || expected) active_ = true;
  if (still_ > hold_ && !expected) active_ = false;
}

Vec2 Pursuit::advance(Memory& memory, int64_t n, Vec2 target, Vec2 noise, Vec2 error, bool visible) {
  const Moment& now = memory[n];
  Moment& next = memory[n + 1];

  // what is seen at both ends of the step: the target's velocity is the step's own, the eye's are remembered
  const Vec2 image = target - memory[n - visual_].reflex + noise;
  slip_ = image - memory[n - visual_].velocity;
  const Vec2 raw0 = image + (p_->copy_gain * memory[n - copy_visual_].copy - memory[n - visual_].velocity);
  const Vec2 raw1 = image + (p_->copy_gain * memory[n + 1 - copy_visual_].copy - memory[n + 1 - visual_].velocity);
  Vec2 seen0 = raw0, seen1 = raw1;
  if (visible) {
    unseen_ = 0;
    if (p_->visual_lag > 0) {
      seen0 = seen_;
      seen1 = sight_.advance(seen_, raw0, raw1);
    }
    held_ = seen1;
  } else {
    unseen_ += 1;
    seen0 = seen1 = unseen_ <= blank_ ? held_ : Vec2{};
  }
  seen_ = seen1;

  if (predicting_) {
    horizontal_.see(0.5 * (seen0.x + seen1.x), visible);
    vertical_.see(0.5 * (seen0.y + seen1.y), visible);
  }
  if (switched_) {
    const Vec2 turned = memory[n + 1 - visual_].head - memory[n - visual_].head;
    switch_over(turned == Vec2{} ? 0 : norm(turned) / h_);
  } else {
    active_ = true;
  }

  if (active_) {
    const Vec2 begin = saturated(drive(seen0, error, -h_) - memory[n - local_].command);
    const Vec2 end = saturated(drive(seen1, error, 0) - memory[n + 1 - local_].command);
    next.command = now.command + (0.5 * h_) * (begin + end);
  } else {
    next.command = fade_ * now.command;
  }
  const Vec2 i0 = memory[n - motor_].command, i1 = memory[n + 1 - motor_].command;
  next.velocity = plant_.advance(now.velocity, i0, i1);
  next.copy = copy_plant_.advance(now.copy, memory[n - copy_motor_].command, memory[n + 1 - copy_motor_].command);
  return (0.5 * h_) * (i0 + i1) - plant_.time * (next.velocity - now.velocity);
}

}  // namespace eye
