#pragma once

namespace manager {

class Manager;

/// The course of one tick: first those write down their state whose time it is, then stage after stage the programs are
/// told the tick and answer, all of a stage at the same time.
///
///   resting --begin--> writing down --all have--> stage 0 --all answered--> stage 1 ... --last--> resting
///                      (when it is time for one)   (stages without a program that is due are passed over)
class Lockstep {
 public:
  explicit Lockstep(Manager& manager) : manager_(manager) {}

  /// A tick is told and not over.
  bool in_flight() const { return stage_ >= 0; }
  /// Neither this nor the writing down before it is under way.
  bool resting() const { return stage_ < 0 && !writing_down_; }

  void begin();
  /// Goes on when everybody answered who is to. False: somebody has not.
  bool step();
  /// The tick is over for those who had not answered. Was one in flight?
  bool abandon();

 private:
  bool begin_checkpoints();
  bool end_checkpoints();
  void begin_stages();
  void begin_stage();
  bool end_stage();

  Manager& manager_;
  bool writing_down_ = false;
  int stage_ = -1;
};

}  // namespace manager
