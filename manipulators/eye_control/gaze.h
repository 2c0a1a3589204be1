#pragma once

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

/// Both eyes of one figure: the model as a fixed-step machine. `advance` makes one internal step; the state after n
/// steps depends on the stimuli alone, never on how the steps were grouped.
///
/// Thread rule: one object, one thread. Objects share nothing but their constant parameters.
class Gaze {
 public:
  /// `parameters` must be free of faults (`fault`).
  explicit Gaze(std::shared_ptr<const Parameters> parameters);

  /// Rest on `aim`: all of the past is this fixation. The step counter becomes `step`.
  void rest(const Aim& aim, int64_t step = 0);

  /// One internal step.
  void advance(const Stimulus& stimulus);

  /// Steps made; the present time is step() * parameters().step.
  int64_t step() const { return n_; }

  Aim aim() const;
  Mode mode() const { return mode_; }
  double lid() const { return memory_[n_].lid; }
  /// Pursuit command and reconstructed target velocity, rad/s.
  Vec2 pursuit_velocity() const { return memory_[n_].velocity; }
  Vec2 pursuit_command() const { return memory_[n_].command; }
  Vec2 target_velocity() const { return pursuit_.target_velocity(); }
  Vec2 trust() const { return pursuit_.trust(); }
  double vergence_rate() const { return vergence_.rate(); }
  int64_t saccades() const { return saccades_; }

  /// A saccade is being prepared: when it starts (step) and where it leads (head frame).
  bool preparing() const { return pending_; }
  int64_t onset() const { return onset_; }

  /// Directions in the head frame (unit vectors) and orientations relative to the head, of the left and the right eye.
  struct Eyes {
    Eigen::Vector3d left_direction, right_direction;
    Eigen::Quaterniond left, right;
  };
  Eyes eyes() const { return eyes(aim()); }
  /// The same for an aim that the eyes need not have.
  Eyes eyes(const Aim& aim) const;

  const Parameters& parameters() const { return *parameters_; }

  /// The whole state, as named rows of numbers, none longer than 1100 numbers times the moments' fields.
  using State = std::map<std::string, std::vector<double>>;
  State save() const;

  /// Continue from a saved state; false, and nothing changed, if it does not fit these parameters.
  bool restore(const State& state);

 private:
  template <class Visit>
  void each(Visit&& visit);

  void snap(const Stimulus& s);
  Vec2 unseen_causes(const Stimulus& s, bool visible);
  void decide(const Stimulus& s, bool visible);
  void prepare(int64_t condition, bool moving);
  void launch(const Stimulus& s);
  Mode present_mode() const;

  std::shared_ptr<const Parameters> parameters_;
  const Parameters& p_;
  Pursuit pursuit_;
  Vergence vergence_;
  Restless restless_;
  Saccade saccade_;
  Memory memory_;
  double rate_;  ///< steps a second
  double vestibular_part_;
  int vestibular_steps_;

  int64_t n_ = 0;
  Mode mode_ = Mode::fixation;
  Vec2 path_;   ///< eye position by a perfect plant, rad
  Vec2 slide_;  ///< low-passed path: what a wrong pulse-step leaves behind
  Vec2 optokinetic_;
  bool pending_ = false, frozen_ = false;
  int64_t onset_ = 0, landed_ = 0;
  Vec2 planned_;
  int64_t saccades_ = 0;
};

}  // namespace eye
