#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "dialog_manager/command.h"
#include "dialog_manager/journal.h"

namespace manager {

/// Keeps a journal of what happens: every accepted line with who said it, and how each tick ended. While a journal is
/// being carried out nothing is kept: it stands there already.
class Recorder {
 public:
  explicit Recorder(Manager& manager) : manager_(manager) {}

  /// Keeps everything from now on, after the world as it stands. Errors: io, busy, exists, limit.
  objdb::Status begin(const std::string& path, Journal::Sync sync);
  /// Goes on behind what was read of a journal. Errors: io, busy.
  objdb::Status resume(const std::string& path, const JournalText& text);
  void end();
  /// Null: nothing is kept.
  Journal* journal() const { return journal_.get(); }

  /// Is there room for a line of this length (for what a tick says)? Error io.
  objdb::Status room_for(std::size_t bytes);
  objdb::Status room_for_tick();
  void add(const Source& source, std::string_view prefix, std::string_view line);
  /// A program begins (ends) to write down its state.
  void add_checkpoint(std::string_view program, bool ended);
  void add_rewind(double time);
  /// The tick that has just ended: its time, and the hash of the world.
  void close_tick();

  /// Hands on what waits. False: it cannot be written any more, which is the end of the manager.
  bool keep(bool tick_ended);

 private:
  void add_world(const std::string& text);
  void add_steering();

  Manager& manager_;
  std::unique_ptr<Journal> journal_;
  bool lost_ = false;
};

}  // namespace manager
