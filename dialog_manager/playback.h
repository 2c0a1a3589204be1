#pragma once

#include <optional>

#include "dialog_manager/command.h"

namespace manager {

/// A journal is being carried out: what that means for everyone else.
class Playback {
 public:
  explicit Playback(Manager& manager) : manager_(manager) {}

  /// The journal says what programs said: they are not told to say it.
  void replaying(bool replaying) { replaying_ = replaying; }
  bool replaying() const { return replaying_; }
  /// The lines that it says next belong to a tick that it has not closed yet.
  void inside_tick(bool inside) { inside_tick_ = inside; }
  bool inside_tick() const { return inside_tick_; }
  /// It says what is said next, and when, while programs do their own work: what was put off is not carried out a
  /// second time, and what a tick did can be taken back.
  void follow(bool follow) { following_ = follow; }
  bool following() const { return following_; }

  /// The tick that it closes.
  void tick();
  /// It has been carried out. `live`: programs that were started on the way take up where they were.
  void end(bool live);
  /// Goes back to a time of the manager's own journal. Errors: io, range.
  Outcome rewind(double time);

 private:
  void empty_world();

  Manager& manager_;
  bool replaying_ = false, inside_tick_ = false, following_ = false;
  std::optional<double> rewinding_;  // to note in the journal when it is done
};

}  // namespace manager
