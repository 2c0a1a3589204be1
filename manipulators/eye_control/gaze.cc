#include "manipulators/eye_control/gaze.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "manipulators/eye_control/random.h"

namespace eye {

namespace {

constexpr double blind_lid = 0.5;             // closure from which nothing is seen
constexpr double recovery = 15;               // steps until vision is trusted after a sweep of gaze by the head
constexpr double vergence_speed = 0.5 * deg;  // from which the mode is called vergence, rad/s
constexpr double shortest_latency = 0.08, longest_latency = 1.5;  // of LATER, s

int look_back(const Pursuit& pursuit, const Vergence& vergence, const Parameters& p) {
  return std::max({pursuit.span(), vergence.span(), static_cast<int>(p.vor_latency / p.step) + 1});
}

}  // namespace

Gaze::Gaze(std::shared_ptr<const Parameters> parameters)
    : parameters_(std::move(parameters)),
      p_(*parameters_),
      pursuit_(p_),
      vergence_(p_),
      restless_(p_),
      memory_(look_back(pursuit_, vergence_, p_)),
      rate_(1 / p_.step),
      vestibular_part_(p_.vor_latency / p_.step - std::floor(p_.vor_latency / p_.step)),
      vestibular_steps_(static_cast<int>(std::floor(p_.vor_latency / p_.step))) {
  rest({});
}

void Gaze::rest(const Aim& aim, int64_t step) {
  Moment moment;
  moment.position = within_range(aim.version, p_.range);
  moment.disparity = moment.vergence = aim.vergence;
  memory_.fill(moment);
  pursuit_ = Pursuit(p_);
  restless_ = Restless(p_);
  saccade_ = Saccade();
  vergence_.rest(aim.vergence);
  path_ = moment.position;
  slide_ = optokinetic_ = planned_ = {};
  pending_ = frozen_ = false;
  mode_ = Mode::fixation;
  n_ = step;
  onset_ = landed_ = step;
}

void Gaze::advance(const Stimulus& s) {
  const Moment& now = memory_[n_];
  Moment& next = memory_[n_ + 1];
  memory_[n_].disparity = s.visible ? s.seen_vergence : memory_[n_ - 1].disparity;
  next.head = now.head + s.head_turn;
  next.lid = restless_.lid(n_);
  next.swept = s.goal.beyond ? recovery : std::max(0.0, now.swept - 1);
  if (p_.method == Method::snap) return snap(s);

  // behind the lid, and while the head sweeps gaze along, nothing is seen
  const Moment& then = memory_[n_ - pursuit_.visual_steps()];
  const bool visible = s.visible && then.lid < blind_lid && then.swept == 0;
  Vec2 moved = unseen_causes(s, visible);
  if (p_.method != Method::saccade_only) {
    Vec2 noise;
    if (p_.slip_noise > 0) {
      const auto seed = static_cast<uint64_t>(p_.seed), count = 2 * static_cast<uint64_t>(n_);
      noise = p_.slip_noise * Vec2{normal(seed, Stream::noise, count), normal(seed, Stream::noise, count + 1)};
    }
    const Vec2 error = visible ? s.seen_from - memory_[n_ - pursuit_.visual_steps()].position : Vec2{};
    moved += pursuit_.advance(memory_, n_, rate_ * (s.seen_to - s.seen_from), noise, error, visible);
  }

  decide(s, visible);
  if (saccade_.active()) {
    const bool flew = saccade_.flying();
    moved += saccade_.advance(p_, p_.step);
    if (flew && !saccade_.flying()) landed_ = n_ + 1;
  }

  // a wrong estimate of the long plant time leaves part of every movement to creep home with that time
  path_ = within_range(path_ + moved, p_.range);
  next.position = path_;
  if (p_.plant_estimate != 1) {
    slide_ = std::exp(-p_.step / p_.long_plant_time) * (slide_ + moved);
    next.position = within_range(path_ + (p_.plant_estimate - 1) * slide_, p_.range);
  }

  next.vergence = vergence_.advance(memory_, n_, pursuit_.visual_steps(), saccade_.flying());
  n_ += 1;
  mode_ = present_mode();
}

// geometry alone
void Gaze::snap(const Stimulus& s) {
  Moment& next = memory_[n_ + 1];
  next.command = next.velocity = next.copy = {};
  next.position = s.present_visible ? s.present.version : memory_[n_].position;
  next.vergence = s.present_visible ? s.present.vergence : memory_[n_].vergence;
  path_ = next.position;
  vergence_.rest(next.vergence);
  n_ += 1;
  mode_ = restless_.blinking() ? Mode::blink : Mode::fixation;
}

// displacement over the step by reflexes, drift and leak: no motor command is copied, so the retina sees all of it
Vec2 Gaze::unseen_causes(const Stimulus& s, bool visible) {
  const int k = vestibular_steps_;
  const double f = vestibular_part_;
  const Vec2 now = (1 - f) * memory_[n_ - k].head + f * memory_[n_ - k - 1].head;
  const Vec2 then = (1 - f) * memory_[n_ + 1 - k].head + f * memory_[n_ - k].head;

  // a gaze shift beyond the eyes' range is the head's to finish: the reflex waits until the target is within reach
  Vec2 moved = s.goal.beyond ? Vec2{} : p_.vor_gain * (then - now);

  // in fixation the remaining slip of the world builds up an optokinetic velocity; what an eye that comes to rest after
  // pursuit makes slip is known from the copy of its command, and is not the world's
  const Vec2 slip = visible && !pursuit_.active() && !s.goal.beyond ? pursuit_.target_velocity() : Vec2{};
  optokinetic_ += p_.step * (p_.optokinetic_gain * slip - (1 / p_.optokinetic_time) * optokinetic_);
  moved += p_.step * optokinetic_ + restless_.drift(n_);
  if (p_.integrator_time > 0) moved -= (p_.step / p_.integrator_time) * path_;
  memory_[n_].reflex = rate_ * moved;
  return moved;
}

// saccades: look for a reason, freeze the plan, launch
void Gaze::decide(const Stimulus& s, bool visible) {
  const int64_t seen_at = n_ - pursuit_.visual_steps();
  const bool moving = p_.method != Method::saccade_only && pursuit_.target_moves();
  if (!pending_ && !saccade_.active() && visible && seen_at >= landed_) {
    const Vec2 error = s.seen_from - memory_[seen_at].position;
    const Vec2 slip = moving ? pursuit_.slip() : Vec2{};
    Vec2 tiny;
    if (wants_saccade(error, slip, p_)) {
      prepare(seen_at, moving);
    } else if (!moving && restless_.microsaccade(n_, error, tiny)) {
      saccade_.begin(tiny, p_);
      saccades_ += 1;
    }
  }
  if (!pending_) return;

  // what the target does from here on comes too late for this saccade
  const int64_t freeze = onset_ - std::max(0, p_.steps(p_.dead_time) - pursuit_.visual_steps());
  const Vec2 velocity = moving ? pursuit_.target_velocity() : Vec2{};
  if (!frozen_ && n_ >= freeze) {
    frozen_ = true;
    planned_ = s.goal.version + (p_.visual_delay + static_cast<double>(onset_ - n_) * p_.step) * velocity;
  } else if (frozen_ && !s.goal.beyond) {
    planned_ += s.head_turn;
  }
  if (n_ >= onset_) launch(s);
}

void Gaze::prepare(int64_t condition, bool moving) {
  double latency = moving ? p_.catch_up_latency : p_.saccade_latency;
  if (p_.later_sigma > 0) {
    // LATER: the rate of rise is normally distributed, so the reciprocal latency is
    const double z = normal(static_cast<uint64_t>(p_.seed), Stream::latency, static_cast<uint64_t>(saccades_));
    const double rate = 1 / p_.saccade_latency + p_.later_sigma * z;
    latency *= 1 / (p_.saccade_latency * std::max(rate, 1 / longest_latency));
    latency = std::max(latency, shortest_latency);
  }
  onset_ = std::max(n_, condition + p_.steps(latency));
  pending_ = true;
  frozen_ = false;
}

void Gaze::launch(const Stimulus& s) {
  pending_ = false;
  const Vec2 position = memory_[n_].position;
  Vec2 displacement = within_range(planned_, p_.range) - position;

  // while the eye flies the target goes on: aim ahead by what pursuit will not cover
  if (pursuit_.active() && !s.goal.beyond) {
    const double flight = 0.021 + 0.0022 / deg * norm(displacement);
    displacement += flight * (pursuit_.target_velocity() - memory_[n_].command);
  }
  displacement = p_.saccade_gain * displacement;
  if (norm(displacement) < 0.5 * p_.dead_zone) return;
  saccade_.begin(displacement, p_);
  saccades_ += 1;
}

Mode Gaze::present_mode() const {
  if (restless_.blinking()) return Mode::blink;
  if (saccade_.flying() || (pending_ && n_ >= onset_)) return Mode::saccade;
  if (pursuit_.active() && p_.method != Method::saccade_only) return Mode::pursuit;
  if (pending_) return Mode::latency;
  if (std::abs(vergence_.rate()) > vergence_speed) return Mode::vergence;
  return Mode::fixation;
}

Aim Gaze::aim() const {
  const Moment& now = memory_[n_];
  return {now.position, now.vergence, false};
}

Gaze::Eyes Gaze::eyes(const Aim& aim) const {
  const auto turned = [&](double side) {
    const Vec2 angles{aim.version.x + side * 0.5 * aim.vergence, aim.version.y};
    return helmholtz_direction(within_range(angles, p_.eye_range));
  };
  Eyes eyes;
  eyes.left_direction = turned(1);
  eyes.right_direction = turned(-1);
  // with vergence the Listing planes turn outwards: the left eye's primary direction to the left
  const double tilt = p_.listing_tilt * 0.5 * aim.vergence;
  eyes.left = listing(eyes.left_direction, -tilt);
  eyes.right = listing(eyes.right_direction, tilt);
  return eyes;
}

template <class Visit>
void Gaze::each(Visit&& visit) {
  visit(n_), visit(path_.x), visit(path_.y), visit(slide_.x), visit(slide_.y);
  visit(optokinetic_.x), visit(optokinetic_.y);
  visit(pending_), visit(frozen_), visit(onset_), visit(landed_), visit(planned_.x), visit(planned_.y),
      visit(saccades_);
  pursuit_.each(visit), vergence_.each(visit), restless_.each(visit), saccade_.each(visit);
}

namespace {

constexpr double Vec2::*components[] = {&Vec2::x, &Vec2::y};
constexpr struct {
  const char* name;
  Vec2 Moment::*pair;
} pairs[] = {{"command", &Moment::command},   {"velocity", &Moment::velocity}, {"copy", &Moment::copy},
             {"position", &Moment::position}, {"head", &Moment::head},         {"reflex", &Moment::reflex}};
constexpr struct {
  const char* name;
  double Moment::*number;
} numbers[] = {{"disparity", &Moment::disparity},
               {"vergence", &Moment::vergence},
               {"lid", &Moment::lid},
               {"swept", &Moment::swept}};

}  // namespace

Gaze::State Gaze::save() const {
  State state;
  auto& now = state["now"];
  now.push_back(static_cast<double>(mode_));
  const_cast<Gaze*>(this)->each([&](auto& value) { now.push_back(static_cast<double>(value)); });

  const int64_t span = look_back(pursuit_, vergence_, p_) + 1;
  for (const auto& [name, pair] : pairs) {
    for (int64_t k = n_ - span; k <= n_; ++k) {
      for (const auto part : components) state[name].push_back(memory_[k].*pair.*part);
    }
  }
  for (const auto& [name, number] : numbers) {
    for (int64_t k = n_ - span; k <= n_; ++k) state[name].push_back(memory_[k].*number);
  }
  return state;
}

bool Gaze::restore(const State& state) {
  const size_t span = static_cast<size_t>(look_back(pursuit_, vergence_, p_)) + 1;
  const auto row = [&](const char* name, size_t size) -> const std::vector<double>* {
    const auto found = state.find(name);
    return found != state.end() && found->second.size() == size ? &found->second : nullptr;
  };
  size_t size = 1;
  each([&](auto&) { size += 1; });
  const auto* now = row("now", size);
  if (!now) return false;
  for (const auto& [name, pair] : pairs) {
    if (!row(name, 2 * (span + 1))) return false;
  }
  for (const auto& [name, number] : numbers) {
    if (!row(name, span + 1)) return false;
  }

  auto value = now->begin();
  mode_ = static_cast<Mode>(static_cast<int>(*value++));
  each([&](auto& place) { place = static_cast<std::remove_reference_t<decltype(place)>>(*value++); });
  for (size_t k = 0; k <= span; ++k) {
    Moment& moment = memory_[n_ - static_cast<int64_t>(span - k)];
    for (const auto& [name, pair] : pairs) {
      for (size_t part = 0; part < 2; ++part) moment.*pair.*components[part] = state.at(name)[2 * k + part];
    }
    for (const auto& [name, number] : numbers) moment.*number = state.at(name)[k];
  }
  return true;
}

}  // namespace eye
