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

template <int W>
int look_back(const Pursuit<W>& pursuit, const Vergence<W>& vergence, const Parameters& p) {
  return std::max({pursuit.span(), vergence.span(), static_cast<int>(p.vor_latency / p.step) + 1});
}

}  // namespace

EyePair eyes_of(const Aim& aim, const Parameters& p) {
  const auto turned = [&](double side) {
    const Vec2 angles{aim.version.x + side * 0.5 * aim.vergence, aim.version.y};
    return helmholtz_direction(within_range(angles, p.eye_range));
  };
  EyePair eyes;
  eyes.left_direction = turned(1);
  eyes.right_direction = turned(-1);
  // with vergence the Listing planes turn outwards: the left eye's primary direction to the left
  const double tilt = p.listing_tilt * 0.5 * aim.vergence;
  eyes.left = listing(eyes.left_direction, -tilt);
  eyes.right = listing(eyes.right_direction, tilt);
  return eyes;
}

template <int W>
Gazes<W>::Gazes(std::shared_ptr<const Parameters> parameters)
    : parameters_(std::move(parameters)),
      p_(*parameters_),
      pursuit_(p_),
      vergence_(p_, pursuit_.visual_steps()),
      memory_(look_back(pursuit_, vergence_, p_)),
      rate_(1 / p_.step),
      vestibular_part_(p_.vor_latency / p_.step - std::floor(p_.vor_latency / p_.step)),
      vestibular_steps_(static_cast<int>(std::floor(p_.vor_latency / p_.step))),
      slide_keep_(std::exp(-p_.step / p_.long_plant_time)),
      restless_(width, Restless(p_, 0)) {
  for (size_t i = 0; i < width; ++i) rest(i, {}, 0);
}

template <int W>
void Gazes<W>::rest(size_t i, const Aim& aim, uint64_t seed) {
  const Vec2 position = within_range(aim.version, p_.range);
  for (size_t k = 0; k < memory_.size(); ++k) {
    Moment<W>& moment = memory_[static_cast<int64_t>(k)];
    for (auto* pair : {&moment.command, &moment.velocity, &moment.copy, &moment.head, &moment.reflex}) pair->put(i, {});
    moment.position.put(i, position);
    moment.disparity[i] = moment.vergence[i] = aim.vergence;
    moment.lid[i] = moment.swept[i] = 0;
  }
  pursuit_.rest(i);
  vergence_.rest(i, aim.vergence);
  restless_[i] = Restless(p_, seed);
  seeds_[i] = seed;
  flights_[i] = Saccade();
  path_.put(i, position);
  slide_.put(i, {});
  optokinetic_.put(i, {});
  intents_[i] = {};
  intents_[i].onset = intents_[i].landed = n_;
}

// -- one step

template <int W>
void Gazes<W>::step_lanes(const Stimulus* stimuli) {
  Input in;
  for (size_t i = 0; i < width; ++i) {
    const Stimulus& s = stimuli[i];
    in.seen_from.put(i, s.seen_from), in.seen_to.put(i, s.seen_to), in.head_turn.put(i, s.head_turn);
    in.seen_vergence[i] = s.seen_vergence;
    in.shown[i] = s.visible, in.beyond[i] = s.goal.beyond;
  }
  Moment<W> next;
  Lanes<W> visible;
  remember(in, next, visible);
  if (p_.method == Method::snap) {
    snap(stimuli, next);
  } else {
    Pairs<W> moved;
    Lanes<W> flying;
    reflexes(in, visible, moved);
    if (p_.method != Method::saccade_only) pursue(in, visible, next, moved);
    saccades(stimuli, visible, moved, flying);
    place(moved, next);
    vergence_.advance(memory_, n_, flying, next);
  }
  memory_[n_ + 1] = next;
  n_ += 1;
}

template <>
void Gazes<1>::advance(const Stimulus* stimuli) {
  step_lanes(stimuli);
}

// wider registers change the speed, not the bits: no operation here is fused or reordered
template <>
__attribute__((target_clones("avx512f", "avx2", "default"))) void Gazes<8>::advance(const Stimulus* stimuli) {
  step_lanes(stimuli);
}

// what later steps will look back to, and what of the target is seen now
template <int W>
void Gazes<W>::remember(const Input& in, Moment<W>& next, Lanes<W>& visible) {
  const Moment<W>&now = memory_[n_], &then = memory_[n_ - pursuit_.visual_steps()];
  const Lanes<W>& before = memory_[n_ - 1].disparity;
  Lanes<W> disparity;
  for (size_t i = 0; i < width; ++i) {
    disparity[i] = in.shown[i] != 0 ? in.seen_vergence[i] : before[i];
    next.head.x[i] = now.head.x[i] + in.head_turn.x[i];
    next.head.y[i] = now.head.y[i] + in.head_turn.y[i];
    const double less = now.swept[i] - 1;
    next.swept[i] = in.beyond[i] != 0 ? recovery : less > 0 ? less : 0;
    // behind the lid, and while the head sweeps gaze along, nothing is seen
    const double seen = then.lid[i] < blind_lid ? in.shown[i] : 0;
    visible[i] = then.swept[i] == 0 ? seen : 0;
  }
  memory_[n_].disparity = disparity;
  memory_[n_ + 1].head = next.head;
  for (size_t i = 0; i < width; ++i) next.lid[i] = restless_[i].blinks() ? restless_[i].lid(n_) : 0;
}

// geometry alone
template <int W>
void Gazes<W>::snap(const Stimulus* stimuli, Moment<W>& next) {
  for (size_t i = 0; i < width; ++i) {
    const Stimulus& s = stimuli[i];
    next.position.put(i, s.present_visible ? s.present.version : memory_[n_].position[i]);
    next.vergence[i] = s.present_visible ? s.present.vergence : memory_[n_].vergence[i];
    vergence_.rest(i, next.vergence[i]);
  }
  path_ = next.position;
}

// displacement over the step by reflexes, drift and leak: no motor command is copied, so the retina sees all of it
template <int W>
void Gazes<W>::reflexes(const Input& in, const Lanes<W>& visible, Pairs<W>& moved) {
  const int k = vestibular_steps_;
  const double f = vestibular_part_, h = p_.step, gain = p_.vor_gain, rate = rate_;
  const double gained = p_.optokinetic_gain, lost = 1 / p_.optokinetic_time;
  const double leak = p_.integrator_time > 0 ? h / p_.integrator_time : 0;
  const Pairs<W>&newest = memory_[n_ + 1 - k].head, &middle = memory_[n_ - k].head, &oldest = memory_[n_ - k - 1].head;
  const Pairs<W> seen = pursuit_.target_velocity(), path = path_;
  const Lanes<W> active = pursuit_.active();
  Pairs<W> drift, optokinetic = optokinetic_, reflex;
  if (p_.drift_speed > 0) {
    for (size_t i = 0; i < width; ++i) drift.put(i, restless_[i].drift(n_));
  }
  const auto component = [&](Lanes<W> Pairs<W>::*part) EYE_LAMBDA {
    for (size_t i = 0; i < width; ++i) {
      const double now = (1 - f) * (middle.*part)[i] + f * (oldest.*part)[i];
      const double then = (1 - f) * (newest.*part)[i] + f * (middle.*part)[i];
      // a gaze shift beyond the eyes' range is the head's to finish: the reflex waits until the target is within reach
      const double vestibular = in.beyond[i] != 0 ? 0 : gain * (then - now);

      // in fixation the remaining slip of the world builds up an optokinetic velocity; what an eye that comes to rest
      // after pursuit makes slip is known from the copy of its command, and is not the world's
      const double fixating = visible[i] != 0 && active[i] == 0 && in.beyond[i] == 0 ? (seen.*part)[i] : 0;
      double& slow = (optokinetic.*part)[i];
      slow = settled(slow + h * (gained * fixating - lost * slow));
      const double all = vestibular + (h * slow + (drift.*part)[i]);
      (moved.*part)[i] = leak > 0 ? all - leak * (path.*part)[i] : all;
      (reflex.*part)[i] = rate * (moved.*part)[i];
    }
  };
  component(&Pairs<W>::x);
  component(&Pairs<W>::y);
  optokinetic_ = optokinetic;
  memory_[n_].reflex = reflex;
}

template <int W>
void Gazes<W>::pursue(const Input& in, const Lanes<W>& visible, Moment<W>& next, Pairs<W>& moved) {
  typename Pursuit<W>::View view;
  const Pairs<W>& position = memory_[n_ - pursuit_.visual_steps()].position;
  const double rate = rate_;
  for (size_t i = 0; i < width; ++i) {
    view.target.x[i] = rate * (in.seen_to.x[i] - in.seen_from.x[i]);
    view.target.y[i] = rate * (in.seen_to.y[i] - in.seen_from.y[i]);
    view.error.x[i] = visible[i] != 0 ? in.seen_from.x[i] - position.x[i] : 0;
    view.error.y[i] = visible[i] != 0 ? in.seen_from.y[i] - position.y[i] : 0;
  }
  view.visible = visible;
  if (p_.slip_noise > 0) {
    const auto count = 2 * static_cast<uint64_t>(n_);
    for (size_t i = 0; i < width; ++i) {
      view.noise.x[i] = p_.slip_noise * normal(seeds_[i], Stream::noise, count);
      view.noise.y[i] = p_.slip_noise * normal(seeds_[i], Stream::noise, count + 1);
    }
  }
  pursuit_.advance(memory_, n_, view, next, moved);
}

template <int W>
void Gazes<W>::saccades(const Stimulus* stimuli, const Lanes<W>& visible, Pairs<W>& moved, Lanes<W>& flying) {
  for (size_t i = 0; i < width; ++i) {
    decide(i, stimuli[i], visible[i] != 0);
    flying[i] = 0;
    if (!flights_[i].active()) continue;
    const bool flew = flights_[i].flying();
    const Vec2 step = flights_[i].advance(p_, p_.step);
    moved.x[i] += step.x, moved.y[i] += step.y;
    flying[i] = flights_[i].flying();
    if (flew && flying[i] == 0) intents_[i].landed = n_ + 1;
  }
}

template <int W>
void Gazes<W>::place(const Pairs<W>& moved, Moment<W>& next) {
  Pairs<W> path;
  double far = 0;
  const double near2 = near_range2(p_.range);
  for (size_t i = 0; i < width; ++i) {
    path.x[i] = path_.x[i] + moved.x[i];
    path.y[i] = path_.y[i] + moved.y[i];
    far += path.x[i] * path.x[i] + path.y[i] * path.y[i] < near2 ? 0 : 1;
  }
  if (far > 0) {
    for (size_t i = 0; i < width; ++i) path.put(i, within_range(path[i], p_.range));
  }
  path_ = next.position = path;
  if (p_.plant_estimate == 1) return;
  // a wrong estimate of the long plant time leaves part of every movement to creep home with that time
  for (size_t i = 0; i < width; ++i) {
    slide_.put(i, slide_keep_ * (slide_[i] + moved[i]));
    next.position.put(i, within_range(path_[i] + (p_.plant_estimate - 1) * slide_[i], p_.range));
  }
}

// -- saccades: look for a reason, freeze the plan, launch

template <int W>
void Gazes<W>::decide(size_t i, const Stimulus& s, bool visible) {
  Intent& intent = intents_[i];
  const int64_t seen_at = n_ - pursuit_.visual_steps();
  if (!intent.pending) {
    if (!visible || flights_[i].active() || seen_at < intent.landed) return;
    const Vec2 error = s.seen_from - memory_[seen_at].position[i];
    const bool off = dot(error, error) > p_.dead_zone * p_.dead_zone;
    if (!off && p_.microsaccade_rate == 0) return;
    const bool moving = p_.method != Method::saccade_only && pursuit_.target_moves(i);
    Vec2 tiny;
    if (wants_saccade(error, moving ? pursuit_.slip(i) : Vec2{}, p_)) {
      prepare(i, seen_at, moving);
    } else if (!moving && restless_[i].microsaccade(n_, error, tiny)) {
      flights_[i].begin(tiny, p_);
      intent.count += 1;
    }
    if (!intent.pending) return;
  }

  // what the target does from here on comes too late for this saccade
  const int64_t freeze = intent.onset - std::max(0, p_.steps(p_.dead_time) - pursuit_.visual_steps());
  if (!intent.frozen && n_ >= freeze) {
    const bool moving = p_.method != Method::saccade_only && pursuit_.target_moves(i);
    const Vec2 velocity = moving ? target_velocity(i) : Vec2{};
    intent.frozen = true;
    intent.planned = s.goal.version + (p_.visual_delay + static_cast<double>(intent.onset - n_) * p_.step) * velocity;
  } else if (intent.frozen && !s.goal.beyond) {
    intent.planned += s.head_turn;
  }
  if (n_ >= intent.onset) launch(i, s);
}

template <int W>
void Gazes<W>::prepare(size_t i, int64_t condition, bool moving) {
  double latency = moving ? p_.catch_up_latency : p_.saccade_latency;
  if (p_.later_sigma > 0) {
    // LATER: the rate of rise is normally distributed, so the reciprocal latency is
    const double z = normal(seeds_[i], Stream::latency, static_cast<uint64_t>(intents_[i].count));
    const double rate = 1 / p_.saccade_latency + p_.later_sigma * z;
    latency *= 1 / (p_.saccade_latency * std::max(rate, 1 / longest_latency));
    latency = std::max(latency, shortest_latency);
  }
  intents_[i].onset = std::max(n_, condition + p_.steps(latency));
  intents_[i].pending = true;
  intents_[i].frozen = false;
}

template <int W>
void Gazes<W>::launch(size_t i, const Stimulus& s) {
  Intent& intent = intents_[i];
  intent.pending = false;
  Vec2 displacement = within_range(intent.planned, p_.range) - memory_[n_].position[i];

  // while the eye flies the target goes on: aim ahead by what pursuit will not cover
  if (pursuit_.active()[i] != 0 && !s.goal.beyond) {
    const double flight = 0.021 + 0.0022 / deg * norm(displacement);
    displacement += flight * (target_velocity(i) - memory_[n_].command[i]);
  }
  displacement = p_.saccade_gain * displacement;
  if (norm(displacement) < 0.5 * p_.dead_zone) return;
  flights_[i].begin(displacement, p_);
  intent.count += 1;
}

template <int W>
Mode Gazes<W>::mode(size_t i) const {
  if (restless_[i].blinking()) return Mode::blink;
  if (p_.method == Method::snap) return Mode::fixation;
  const Intent& intent = intents_[i];
  if (flights_[i].flying()) return Mode::saccade;
  // the step that now begins will be its first, unless the target has come to the eye meanwhile
  if (intent.pending && n_ >= intent.onset) {
    const Vec2 left = within_range(intent.planned, p_.range) - memory_[n_].position[i];
    if (p_.saccade_gain * norm(left) >= 0.5 * p_.dead_zone) return Mode::saccade;
  }
  if (pursuit_.active()[i] != 0 && p_.method != Method::saccade_only) return Mode::pursuit;
  if (intent.pending) return Mode::latency;
  if (std::abs(vergence_.rate(i)) > vergence_speed) return Mode::vergence;
  return Mode::fixation;
}

// -- the state as numbers

template <int W>
template <class Visit>
void Gazes<W>::each(size_t i, Visit&& visit) {
  Intent& intent = intents_[i];
  for (auto* pair : {&path_, &slide_, &optokinetic_}) visit(pair->x[i]), visit(pair->y[i]);
  visit(intent.pending), visit(intent.frozen), visit(intent.onset), visit(intent.landed), visit(intent.planned.x),
      visit(intent.planned.y), visit(intent.count);
  pursuit_.each(i, visit), vergence_.each(i, visit), restless_[i].each(visit), flights_[i].each(visit);
}

namespace {

template <int W>
struct PairRow {
  const char* name;
  Pairs<W> Moment<W>::*pair;
};
template <int W>
constexpr PairRow<W> pairs[] = {{"command", &Moment<W>::command}, {"velocity", &Moment<W>::velocity},
                                {"copy", &Moment<W>::copy},       {"position", &Moment<W>::position},
                                {"head", &Moment<W>::head},       {"reflex", &Moment<W>::reflex}};
template <int W>
struct NumberRow {
  const char* name;
  Lanes<W> Moment<W>::*number;
};
template <int W>
constexpr NumberRow<W> numbers[] = {{"disparity", &Moment<W>::disparity},
                                    {"vergence", &Moment<W>::vergence},
                                    {"lid", &Moment<W>::lid},
                                    {"swept", &Moment<W>::swept}};

}  // namespace

template <int W>
typename Gazes<W>::State Gazes<W>::save(size_t i) const {
  State state;
  auto& now = state["now"];
  now.push_back(static_cast<double>(n_));
  const_cast<Gazes*>(this)->each(i, [&](auto& value) { now.push_back(static_cast<double>(value)); });

  const int64_t span = look_back(pursuit_, vergence_, p_) + 1;
  for (int64_t k = n_ - span; k <= n_; ++k) {
    for (const auto& [name, pair] : pairs<W>) {
      const Vec2 v = (memory_[k].*pair)[i];
      state[name].insert(state[name].end(), {v.x, v.y});
    }
    for (const auto& [name, number] : numbers<W>) state[name].push_back((memory_[k].*number)[i]);
  }
  return state;
}

template <int W>
int64_t Gazes<W>::step_of(const State& state) {
  const auto now = state.find("now");
  return now == state.end() || now->second.empty() ? 0 : static_cast<int64_t>(now->second[0]);
}

template <int W>
bool Gazes<W>::restore(size_t i, const State& state, uint64_t seed) {
  const auto row = [&](const char* name) -> const std::vector<double>* {
    const auto found = state.find(name);
    return found != state.end() ? &found->second : nullptr;
  };
  size_t size = 1;
  each(i, [&](auto&) { size += 1; });
  const auto *now = row("now"), *lid = row("lid");
  if (!now || now->size() != size || static_cast<int64_t>((*now)[0]) != n_ || !lid || lid->empty()) return false;
  const size_t count = lid->size();
  for (const auto& [name, pair] : pairs<W>) {
    if (!row(name) || row(name)->size() != 2 * count) return false;
  }
  for (const auto& [name, number] : numbers<W>) {
    if (!row(name) || row(name)->size() != count) return false;
  }

  rest(i, {}, seed);
  auto value = now->begin() + 1;
  each(i, [&](auto& place) { place = static_cast<std::remove_reference_t<decltype(place)>>(*value++); });
  for (size_t back = 0; back < memory_.size(); ++back) {
    Moment<W>& moment = memory_[n_ - static_cast<int64_t>(back)];
    const size_t k = count - 1 - std::min(back, count - 1);
    for (const auto& [name, pair] : pairs<W>) {
      const std::vector<double>& x = state.at(name);
      (moment.*pair).put(i, {x[2 * k], x[2 * k + 1]});
    }
    for (const auto& [name, number] : numbers<W>) (moment.*number)[i] = state.at(name)[k];
  }
  return true;
}

template class Gazes<1>;
template class Gazes<8>;

}  // namespace eye
