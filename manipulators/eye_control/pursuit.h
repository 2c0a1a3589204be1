#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "manipulators/eye_control/lag.h"
#include "manipulators/eye_control/memory.h"
#include "manipulators/eye_control/parameters.h"
#include "manipulators/eye_control/predictor.h"

namespace eye {

/// Smooth pursuit: the delayed, saturating loop with an efference copy of the motor command.
///
///     slip(t) = target velocity - eye velocity            seen after visual_delay (and visual_lag)
///     That    = slip(t - tv) + g w(t - tv')               reconstructed target velocity
///     u       = P VS(That), blended with the forecast     VS: clamp of the speed
///     c'      = AS(K (u - c(t - tm)))                     AS(x) = x / (1 + |x| / limit), the premotor loop
///     v'      = (c(t - to) - v) / T2                      the eye after the matched pulse-step
///     w'      = (c(t - to') - w) / T2'                    the brain's copy of v
///
/// Every delay is at least one step, so over a step all delayed terms are known: c is a pure quadrature (trapezoid,
/// with one-sided limits at the ends of the step) and v, w are exponentials with linear forcing (exact). Second order,
/// no stability limit from the saturations, no iteration.
template <int W>
class Pursuit {
 public:
  explicit Pursuit(const Parameters& p);

  /// Lane `i` forgets everything.
  void rest(size_t i);

  /// How far back the step looks, steps.
  int span() const { return std::max({k_.visual, k_.copy_visual, k_.local, k_.motor, k_.copy_motor}); }
  int visual_steps() const { return k_.visual; }

  /// What the step from n to n + 1 shows.
  struct View {
    Pairs<W> target;  ///< mean target velocity over the step as it was visual_steps ago (head frame), rad/s
    Pairs<W> noise;   ///< added to what is seen, rad/s
    Pairs<W> error;   ///< position error seen, rad: as far as the forecast is trusted, it is closed at `position_rate`,
                      ///< since an eye that keeps up would else keep its distance too
    Lanes<W> visible;  ///< 0 or 1
  };

  /// One step. Writes command, velocity and copy of moment n + 1 into `next`, adds the displacement of the eye, rad, to
  /// `moved`.
  EYE_INLINE void advance(const Memory<W>& memory, int64_t n, const View& view, Moment<W>& next, Pairs<W>& moved);

  /// Reconstructed target velocity at the end of the last step, rad/s.
  const Pairs<W>& target_velocity() const { return s_.seen; }
  /// It is fast enough to be pursued.
  bool target_moves(size_t i) const { return dot(s_.seen[i], s_.seen[i]) > p_->pursuit_on * p_->pursuit_on; }
  /// Retinal slip at the start of the last step (visual_steps ago), rad/s.
  Vec2 slip(size_t i) const { return s_.slip[i]; }
  /// Pursuit is switched on: 0 or 1.
  const Lanes<W>& active() const { return s_.active; }
  /// Trust in the forecast of each component.
  Vec2 trust(size_t i) const { return s_.trust[i]; }

  template <class Visit>
  void each(size_t i, Visit&& visit) {
    for (auto* pair : {&s_.seen, &s_.slip, &s_.held}) visit(pair->x[i]), visit(pair->y[i]);
    visit(s_.active[i]), visit(s_.head_speed[i]), visit(s_.still[i]), visit(s_.unseen[i]);
    horizontal_[i].each(visit), vertical_[i].each(visit);
    s_.trust.put(i, {horizontal_[i].trust(), vertical_[i].trust()});
  }

 private:
  static constexpr size_t width = W;

  struct Constants {
    int visual, copy_visual, local, motor, copy_motor;
    double step, gain, copy_gain, local_gain, acceleration_limit, velocity_limit, on, off, hold, blank, fade, forget;
    bool linear, switched, predicting;
    Lag plant, copy_plant, sight;
  };
  struct State {
    Pairs<W> seen, slip, held, trust;
    Lanes<W> active{}, head_speed{}, still{}, unseen{};
  };
  /// reconstructed target velocity at both ends of the step
  struct Seen {
    Pairs<W> begin, end;
  };

  EYE_INLINE void look(const Memory<W>& memory, int64_t n, const View& view, Seen& seen);
  EYE_INLINE void feel_head(const Memory<W>& memory, int64_t n);
  EYE_INLINE void predict(const Seen& seen, const Lanes<W>& visible);
  EYE_INLINE void switch_over();
  EYE_INLINE Pairs<W> drive(const Pairs<W>& seen, const Pairs<W>& error, double ahead) const;
  Vec2 forecast(size_t i, Vec2 error, double ahead) const;
  EYE_INLINE Pairs<W> acceleration(const Pairs<W>& wanted, const Pairs<W>& command) const;

  const Parameters* p_;
  Constants k_;
  State s_;
  std::vector<Predictor> horizontal_, vertical_;
};

namespace pursuit_numbers {
inline constexpr double blank_time = 0.1;        // how long a hidden target is taken to go on as before, s
inline constexpr double attributed = 0.1;        // share of head speed that is taken for a fault of the reflex
inline constexpr double attribution = 0.1;       // and for how long after, s
inline constexpr double trusted = 0.1;           // trust from which a forecast alone keeps pursuit on
inline constexpr double inversion_limit = 0.95;  // share of the acceleration limit that a forecast may ask for
}  // namespace pursuit_numbers

template <int W>
Pursuit<W>::Pursuit(const Parameters& p)
    : p_(&p),
      k_{p.steps(p.visual_delay),
         p.steps(p.copy_visual_delay),
         p.steps(p.local_delay),
         p.steps(p.motor_delay),
         p.steps(p.copy_motor_delay),
         p.step,
         p.pursuit_gain,
         p.copy_gain,
         p.local_gain,
         p.acceleration_limit,
         p.velocity_limit,
         p.pursuit_on,
         p.pursuit_off,
         static_cast<double>(std::lround(p.offset_hold / p.step)),
         static_cast<double>(p.steps(pursuit_numbers::blank_time)),
         std::exp(-p.step / p.offset_time),
         std::exp(-p.step / pursuit_numbers::attribution),
         p.method == Method::linear,
         p.offset_switch >= 0.5 && p.method != Method::linear,
         p.predictor >= 0.5 && p.method != Method::linear,
         Lag(p.plant_time, p.step),
         Lag(p.copy_plant_time, p.step),
         Lag(p.visual_lag, p.step)},
      horizontal_(width, Predictor(p)),
      vertical_(width, Predictor(p)) {
  k_.predicting = k_.predicting && p.visual_delay + p.motor_delay + p.visual_lag < horizontal_[0].horizon();
}

template <int W>
void Pursuit<W>::rest(size_t i) {
  for (auto* pair : {&s_.seen, &s_.slip, &s_.held, &s_.trust}) pair->put(i, {});
  for (auto* number : {&s_.active, &s_.head_speed, &s_.still, &s_.unseen}) (*number)[i] = 0;
  horizontal_[i] = vertical_[i] = Predictor(*p_);
}

// what is seen at both ends of the step: the target's velocity is the step's own, the eye's are remembered
template <int W>
void Pursuit<W>::look(const Memory<W>& memory, int64_t n, const View& view, Seen& seen) {
  const Constants k = k_;
  const Moment<W>&then = memory[n - k.visual], &after = memory[n + 1 - k.visual];
  const Moment<W>&copied = memory[n - k.copy_visual], &copied_after = memory[n + 1 - k.copy_visual];
  State s = s_;
  const bool lagged = k.sight.time > 0;
  const auto component = [&](Lanes<W> Pairs<W>::*part) EYE_LAMBDA {
    for (size_t i = 0; i < width; ++i) {
      const double image = (view.target.*part)[i] - (then.reflex.*part)[i] + (view.noise.*part)[i];
      const double eye = (then.velocity.*part)[i];
      const double raw0 = image + (k.copy_gain * (copied.copy.*part)[i] - eye);
      const double raw1 = image + (k.copy_gain * (copied_after.copy.*part)[i] - (after.velocity.*part)[i]);
      (s.slip.*part)[i] = image - eye;

      const double before = (s.seen.*part)[i];
      const double clear0 = lagged ? before : raw0, clear1 = lagged ? k.sight.advance(before, raw0, raw1) : raw1;
      // a hidden target is taken to go on for a while
      const double guess = s.unseen[i] + 1 <= k.blank ? (s.held.*part)[i] : 0;
      const bool visible = view.visible[i] != 0;
      (seen.begin.*part)[i] = visible ? clear0 : guess;
      (seen.end.*part)[i] = visible ? clear1 : guess;
      (s.held.*part)[i] = visible ? clear1 : (s.held.*part)[i];
    }
  };
  component(&Pairs<W>::x);
  component(&Pairs<W>::y);
  for (size_t i = 0; i < width; ++i) s.unseen[i] = view.visible[i] != 0 ? 0 : s.unseen[i] + 1;
  s.seen = seen.end;
  s_ = s;
}

// what moves on the retina while the head turns is put down to the reflex, as far as that may be
template <int W>
void Pursuit<W>::feel_head(const Memory<W>& memory, int64_t n) {
  const Constants k = k_;
  const Pairs<W>&from = memory[n - k.visual].head, &to = memory[n + 1 - k.visual].head;
  Lanes<W> speed = s_.head_speed;
  for (size_t i = 0; i < width; ++i) {
    const double x = to.x[i] - from.x[i], y = to.y[i] - from.y[i];
    const double turning = std::sqrt(x * x + y * y) / k.step, remembered = k.forget * speed[i];
    speed[i] = settled(turning < remembered ? remembered : turning);
  }
  s_.head_speed = speed;
}

template <int W>
void Pursuit<W>::predict(const Seen& seen, const Lanes<W>& visible) {
  for (size_t i = 0; i < width; ++i) {
    const bool sees = visible[i] != 0;
    const double doubt = pursuit_numbers::attributed * s_.head_speed[i];
    const bool closed = horizontal_[i].see(0.5 * (seen.begin.x[i] + seen.end.x[i]), sees, doubt);
    vertical_[i].see(0.5 * (seen.begin.y[i] + seen.end.y[i]), sees, doubt);
    if (closed) s_.trust.put(i, {horizontal_[i].trust(), vertical_[i].trust()});
  }
}

// pursuit starts and ends as a whole; fixation is not pursuit of a target at rest
template <int W>
void Pursuit<W>::switch_over() {
  using namespace pursuit_numbers;
  const Constants k = k_;
  State s = s_;
  for (size_t i = 0; i < width; ++i) {
    const double reflex = attributed * s.head_speed[i], on = k.on + reflex, off = k.off + reflex;
    const double speed2 = s.seen.x[i] * s.seen.x[i] + s.seen.y[i] * s.seen.y[i];
    s.still[i] = speed2 < off * off ? s.still[i] + 1 : 0;
    const double trust = s.trust.x[i] < s.trust.y[i] ? s.trust.y[i] : s.trust.x[i];
    const double expected = trust > trusted ? 1 : 0;
    const double started = speed2 > on * on ? 1 : s.active[i];
    const double ended = s.still[i] > k.hold ? 0 : started;
    s.active[i] = expected != 0 ? 1 : ended;
  }
  s_.still = s.still, s_.active = s.active;
}

// the premotor input `ahead` of the last seen step: what is seen, as far as the forecast is not trusted
template <int W>
Pairs<W> Pursuit<W>::drive(const Pairs<W>& seen, const Pairs<W>& error, double ahead) const {
  const Constants k = k_;
  Pairs<W> u;
  if (k.linear) {
    for (size_t i = 0; i < width; ++i) u.x[i] = k.gain * seen.x[i], u.y[i] = k.gain * seen.y[i];
    return u;
  }
  Lanes<W> speed2, share;
  double fast = 0, trusting = 0;
  for (size_t i = 0; i < width; ++i) {
    speed2[i] = seen.x[i] * seen.x[i] + seen.y[i] * seen.y[i];
    share[i] = 1;
  }
  const double limit2 = k.velocity_limit * k.velocity_limit;
  for (size_t i = 0; i < width; ++i) fast += speed2[i] > limit2 ? 1 : 0;
  for (size_t i = 0; i < width; ++i) trusting += s_.trust.x[i] + s_.trust.y[i];
  if (fast > 0) {
    for (size_t i = 0; i < width; ++i) share[i] = speed2[i] > limit2 ? k.velocity_limit / std::sqrt(speed2[i]) : 1;
  }
  for (size_t i = 0; i < width; ++i) {
    u.x[i] = k.gain * share[i] * seen.x[i];
    u.y[i] = k.gain * share[i] * seen.y[i];
  }
  if (!k.predicting || trusting == 0) return u;
  for (size_t i = 0; i < width; ++i) {
    const double tx = s_.trust.x[i], ty = s_.trust.y[i];
    if (tx == 0 && ty == 0) continue;
    const Vec2 expected = forecast(i, error[i], ahead);
    u.x[i] += tx * (expected.x - u.x[i]);
    u.y[i] += ty * (expected.y - u.y[i]);
  }
  return u;
}

// inverse of loop and plant: command q(t) = T(t + to) + T2 T'(t + to) makes the eye's velocity T(t); the loop follows q
// when fed q(t - tm) + AS^-1(q') / K
template <int W>
Vec2 Pursuit<W>::forecast(size_t i, Vec2 error, double ahead) const {
  const double horizon = p_->visual_delay + p_->visual_lag + p_->motor_delay + ahead;
  const auto x = horizontal_[i].ahead(horizon), y = vertical_[i].ahead(horizon);
  const auto x_before = horizontal_[i].ahead(horizon - p_->local_delay),
             y_before = vertical_[i].ahead(horizon - p_->local_delay);
  const Vec2 before{x_before.value + p_->plant_time * x_before.rate, y_before.value + p_->plant_time * y_before.rate};
  Vec2 rate{x.rate + p_->plant_time * x.curvature, y.rate + p_->plant_time * y.curvature};
  const double most = pursuit_numbers::inversion_limit * p_->acceleration_limit, size = norm(rate);
  if (size > most) rate = (most / size) * rate;
  const double gain = p_->local_gain * (1 - norm(rate) / p_->acceleration_limit);
  return before + (1 / gain) * rate + p_->position_rate * error;
}

// soft limit of acceleration: direction kept, size x / (1 + x / limit)
template <int W>
Pairs<W> Pursuit<W>::acceleration(const Pairs<W>& wanted, const Pairs<W>& command) const {
  const Constants k = k_;
  Pairs<W> a;
  for (size_t i = 0; i < width; ++i) {
    const double x = k.local_gain * (wanted.x[i] - command.x[i]), y = k.local_gain * (wanted.y[i] - command.y[i]);
    const double factor = k.linear ? 1 : 1 / (1 + std::sqrt(x * x + y * y) / k.acceleration_limit);
    a.x[i] = factor * x;
    a.y[i] = factor * y;
  }
  return a;
}

template <int W>
void Pursuit<W>::advance(const Memory<W>& memory, int64_t n, const View& view, Moment<W>& next, Pairs<W>& moved) {
  Seen seen;
  look(memory, n, view, seen);
  feel_head(memory, n);
  if (k_.predicting) predict(seen, view.visible);
  if (k_.switched) {
    switch_over();
  } else {
    s_.active.fill(1);
  }

  const Constants k = k_;
  const Lanes<W> active = s_.active;
  const Pairs<W> begin = acceleration(drive(seen.begin, view.error, -k.step), memory[n - k.local].command);
  const Pairs<W> end = acceleration(drive(seen.end, view.error, 0), memory[n + 1 - k.local].command);
  const Moment<W>& now = memory[n];
  const Pairs<W>&i0 = memory[n - k.motor].command, &i1 = memory[n + 1 - k.motor].command;
  const Pairs<W>&j0 = memory[n - k.copy_motor].command, &j1 = memory[n + 1 - k.copy_motor].command;
  const double half = 0.5 * k.step;
  const auto component = [&](Lanes<W> Pairs<W>::*part) EYE_LAMBDA {
    for (size_t i = 0; i < width; ++i) {
      const double c = (now.command.*part)[i], v = (now.velocity.*part)[i];
      const double driven = c + half * ((begin.*part)[i] + (end.*part)[i]), fading = settled(k.fade * c);
      const double v1 = settled(k.plant.advance(v, (i0.*part)[i], (i1.*part)[i]));
      (next.command.*part)[i] = active[i] != 0 ? driven : fading;
      (next.velocity.*part)[i] = v1;
      (next.copy.*part)[i] = settled(k.copy_plant.advance((now.copy.*part)[i], (j0.*part)[i], (j1.*part)[i]));
      (moved.*part)[i] += half * ((i0.*part)[i] + (i1.*part)[i]) - k.plant.time * (v1 - v);
    }
  };
  component(&Pairs<W>::x);
  component(&Pairs<W>::y);
}

}  // namespace eye
