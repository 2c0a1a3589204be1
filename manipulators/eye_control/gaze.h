#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "manipulators/eye_control/aim.h"
#include "manipulators/eye_control/memory.h"
#include "manipulators/eye_control/parameters.h"
#include "manipulators/eye_control/pursuit.h"
#include "manipulators/eye_control/restless.h"
#include "manipulators/eye_control/saccade.h"
#include "manipulators/eye_control/vergence.h"

namespace eye {

/// What the eyes are given for one internal step, from t to t + 1 ms. All angles are Helmholtz angles in the head
/// frame.
struct Stimulus {
  /// the target over the step as it was `visual_delay` ago: both ends, so that a jump between steps is no motion
  Vec2 seen_from, seen_to;
  double seen_vergence = 0;
  bool visible = false;
  /// where the target as last seen lies in the head's present frame (the memory of it, turned with the head)
  Aim goal;
  /// the eye turn that would exactly cancel the head's turn over the step
  Vec2 head_turn;
  /// the true present aim; used by `Method::snap` only
  Aim present;
  bool present_visible = false;
};

/// Directions in the head frame (unit vectors) and orientations relative to the head, of the left and the right eye.
struct EyePair {
  Eigen::Vector3d left_direction, right_direction;
  Eigen::Quaterniond left, right;
};

/// The eyes of an aim, each within its mechanical range, by Listing's law.
EyePair eyes_of(const Aim& aim, const Parameters& p);

/// The eyes of W figures side by side, all with the same parameters (but for the seed) and at the same time: the model
/// as a fixed-step machine. What all figures do in every step is loops over lanes; what few do - a saccade in flight, a
/// trusted forecast - is done lane by lane. The state of a lane after n steps depends on its stimuli alone, never on W,
/// on its neighbours or on how the steps were grouped. Instances: 1 and 8.
///
/// Thread rule: one object, one thread. Objects share nothing but their constant parameters.
template <int W>
class Gazes {
 public:
  static constexpr size_t width = W;

  /// `parameters` must be free of faults (`fault`). All lanes rest straight ahead at step 0.
  explicit Gazes(std::shared_ptr<const Parameters> parameters);

  /// The step counter becomes `step`; every lane must be put to rest or restored thereafter.
  void start(int64_t step) { n_ = step; }

  /// Lane `i` rests on `aim`: all of its past is this fixation.
  void rest(size_t i, const Aim& aim, uint64_t seed);

  /// One internal step of all lanes; W stimuli.
  void advance(const Stimulus* stimuli);

  /// Steps made; the present time is step() * parameters().step.
  int64_t step() const { return n_; }
  const Parameters& parameters() const { return *parameters_; }

  Aim aim(size_t i) const { return {memory_[n_].position[i], memory_[n_].vergence[i], false}; }
  Mode mode(size_t i) const;
  double lid(size_t i) const { return memory_[n_].lid[i]; }
  /// Pursuit command and reconstructed target velocity, rad/s.
  Vec2 pursuit_velocity(size_t i) const { return memory_[n_].velocity[i]; }
  Vec2 pursuit_command(size_t i) const { return memory_[n_].command[i]; }
  Vec2 target_velocity(size_t i) const { return pursuit_.target_velocity()[i]; }
  Vec2 trust(size_t i) const { return pursuit_.trust(i); }
  double vergence_rate(size_t i) const { return vergence_.rate(i); }
  int64_t saccades(size_t i) const { return intents_[i].count; }

  /// A saccade is being prepared: when it starts (step).
  bool preparing(size_t i) const { return intents_[i].pending; }
  int64_t onset(size_t i) const { return intents_[i].onset; }

  /// The whole state of a lane, as named rows of numbers, none longer than 1100 numbers times the moments' fields.
  using State = std::map<std::string, std::vector<double>>;
  State save(size_t i) const;

  /// Lane `i` continues from a saved state; false, and nothing changed, if it makes no sense or is of another step.
  /// Under other delays than it was saved with, what it does not reach back to is taken to have been as at its start.
  bool restore(size_t i, const State& state, uint64_t seed);
  /// The step that a saved state is of.
  static int64_t step_of(const State& state);

 private:
  /// the stimuli, side by side
  struct Input {
    Pairs<W> seen_from, seen_to, head_turn;
    Lanes<W> seen_vergence, shown, beyond;
  };
  /// the next saccade of one lane
  struct Intent {
    bool pending = false, frozen = false;
    int64_t onset = 0, landed = 0;
    Vec2 planned;
    int64_t count = 0;
  };

  template <class Visit>
  void each(size_t i, Visit&& visit);

  EYE_INLINE void step_lanes(const Stimulus* stimuli);
  void snap(const Stimulus* stimuli, Moment<W>& next);
  EYE_INLINE void remember(const Input& in, Moment<W>& next, Lanes<W>& visible);
  EYE_INLINE void reflexes(const Input& in, const Lanes<W>& visible, Pairs<W>& moved);
  EYE_INLINE void pursue(const Input& in, const Lanes<W>& visible, Moment<W>& next, Pairs<W>& moved);
  EYE_INLINE void saccades(const Stimulus* stimuli, const Lanes<W>& visible, Pairs<W>& moved, Lanes<W>& flying);
  EYE_INLINE void place(const Pairs<W>& moved, Moment<W>& next);
  EYE_INLINE void decide(size_t i, const Stimulus& s, bool visible);
  void prepare(size_t i, int64_t condition, bool moving);
  void launch(size_t i, const Stimulus& s);

  std::shared_ptr<const Parameters> parameters_;
  const Parameters& p_;
  Pursuit<W> pursuit_;
  Vergence<W> vergence_;
  Memory<W> memory_;
  double rate_;  ///< steps a second
  double vestibular_part_;
  int vestibular_steps_;
  double slide_keep_;

  int64_t n_ = 0;
  Pairs<W> path_;   ///< eye position by a perfect plant, rad
  Pairs<W> slide_;  ///< low-passed path: what a wrong pulse-step leaves behind
  Pairs<W> optokinetic_;
  std::array<Intent, width> intents_;
  std::array<Saccade, width> flights_;
  std::vector<Restless> restless_;
  std::array<uint64_t, width> seeds_{};
};

template <>
void Gazes<1>::advance(const Stimulus* stimuli);
template <>
void Gazes<8>::advance(const Stimulus* stimuli);

/// One pair of eyes alone.
class Gaze {
 public:
  explicit Gaze(std::shared_ptr<const Parameters> parameters)
      : one_(std::move(parameters)), seed_(static_cast<uint64_t>(one_.parameters().seed)) {
    rest({});
  }

  /// Rest on `aim`: all of the past is this fixation. The step counter becomes `step`.
  void rest(const Aim& aim, int64_t step = 0) { one_.start(step), one_.rest(0, aim, seed_); }
  void advance(const Stimulus& stimulus) { one_.advance(&stimulus); }

  int64_t step() const { return one_.step(); }
  const Parameters& parameters() const { return one_.parameters(); }
  Aim aim() const { return one_.aim(0); }
  Mode mode() const { return one_.mode(0); }
  double lid() const { return one_.lid(0); }
  Vec2 pursuit_velocity() const { return one_.pursuit_velocity(0); }
  Vec2 pursuit_command() const { return one_.pursuit_command(0); }
  Vec2 target_velocity() const { return one_.target_velocity(0); }
  Vec2 trust() const { return one_.trust(0); }
  double vergence_rate() const { return one_.vergence_rate(0); }
  int64_t saccades() const { return one_.saccades(0); }
  bool preparing() const { return one_.preparing(0); }
  int64_t onset() const { return one_.onset(0); }
  EyePair eyes() const { return eyes_of(aim(), parameters()); }

  using State = Gazes<1>::State;
  State save() const { return one_.save(0); }
  bool restore(const State& state) {
    const int64_t before = one_.step();
    one_.start(Gazes<1>::step_of(state));
    if (one_.restore(0, state, seed_)) return true;
    one_.start(before);
    return false;
  }

 private:
  Gazes<1> one_;
  uint64_t seed_;
};

}  // namespace eye
