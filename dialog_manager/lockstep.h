#pragma once

namespace manager {

class Manager;
class Manipulator;

/// The course of one tick: first those write down their state whose time it is, then stage after stage the programs are
/// told the tick and answer, all of a stage at the same time.
///
///   resting --begin--> writing down --all have--> stage 0 --all answered--> stage 1 ... --last--> resting
///                      (when it is time for one)   (stages without a program that is due are passed over)
///   resting --write_down--> writing down --all have--> resting
///
/// A program that fails on the way is waited for no longer; the others finish the tick, so that what they know and what
/// the world has stay the same.
class Lockstep {
 public:
  explicit Lockstep(Manager& manager) : manager_(manager) {}

  /// A tick is told and not over.
  bool in_flight() const { return stage_ >= 0; }
  /// Neither this nor the writing down before it is under way.
  bool resting() const { return stage_ < 0 && !writing_down_; }

  void begin();
  /// Has a program, or with null all of them, write down their state now. It must be resting().
  void write_down(const Manipulator* only);
  /// Goes on when everybody answered who is to. False: somebody has not.
  bool step();

 private:
  bool begin_checkpoints();
  bool end_checkpoints();
  void begin_stages();
  void begin_stage();
  bool end_stage();

  Manager& manager_;
  bool writing_down_ = false, tick_follows_ = false;
  int stage_ = -1;
};

}  // namespace manager
