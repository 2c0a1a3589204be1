#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dialog_manager/array_file.h"
#include "objdb/result.h"

namespace manager {

/// One line of a journal: who said it, in which tick, below which prefix (docs/journal.md).
struct Record {
  std::uint64_t tick = 0;  ///< tick that it belongs to; lines between ticks carry the tick before them
  std::string_view source;
  std::string_view prefix;  ///< of a script read `under` a place, "" for none
  std::string_view line;
};

/// What a journal begins with, and where the world stood.
struct JournalStart {
  std::uint64_t tick = 0;
  double time = 0, rate = 60;
  std::uint64_t seed = 0;
  std::uint64_t base_tick = 0;  ///< and what its time was computed from
  double base_time = 0;
};

/// Every accepted line, stamped, on disk before it is acknowledged. A text file; each line carries a check over itself
/// and all lines before it, so that a torn end or a flipped bit is found. One writer at a time.
class Journal {
 public:
  enum class Sync { none, everysec, tick, always };

  /// Begins a journal, or goes on with one after `good` bytes. Errors: io (no regular file, not ours, no room), busy
  /// (another manager writes it).
  static objdb::Result<std::unique_ptr<Journal>> create(const std::string& path, Sync sync, const JournalStart& start);
  static objdb::Result<std::unique_ptr<Journal>> resume(const std::string& path, Sync sync, std::size_t good,
                                                        std::uint64_t check);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Is there room on the disk for a line of this length? Error io when there is not: the line must not be accepted.
  objdb::Status reserve(std::size_t bytes);
  /// The same for a whole tick, as long as twice the longest so far.
  objdb::Status reserve_tick();
  /// Keeps the numbers of a long array beside the journal: the words that tell where. Error io.
  objdb::Result<std::string> add_array(const objdb::Numbers& numbers);
  void add(std::uint64_t tick, std::string_view source, std::string_view prefix, std::string_view line);
  /// Hands what was added to the system, and to the disk as the policy wants it. Call before acknowledging. Error io:
  /// the disk breaks, and what was added since the last good call may be lost; every later call says so again.
  objdb::Status flush(bool tick_ended);

  const std::string& path() const { return path_; }

 private:
  Journal() = default;
  static objdb::Result<std::unique_ptr<Journal>> open(const std::string& path, Sync sync, int flags);

  std::string path_;
  int file_ = -1;
  Sync sync_ = Sync::everysec;
  std::uint64_t check_ = 0;
  std::string buffer_;
  std::size_t size_ = 0;      // bytes written
  std::size_t reserved_ = 0;  // bytes that the disk holds for us
  std::optional<std::size_t> tick_start_;
  std::size_t longest_tick_ = 0;
  bool unsynced_ = false;
  objdb::Status kept_;
  std::unique_ptr<ArrayFile> arrays_;  // from the first array on
  std::chrono::steady_clock::time_point synced_at_{};
};

/// A journal as it was read: everything up to the last line that is whole, the lines of a tick only when the tick is.
/// Its records point into its text.
struct JournalText {
  std::string path;
  std::shared_ptr<const std::string> text;
  std::shared_ptr<std::deque<std::string>> names;  ///< those that stand in quotes
  JournalStart start;
  std::vector<Record> records;
  std::size_t good = 0;     ///< bytes of the file up to there
  std::uint64_t check = 0;  ///< check after them
  std::string flaw;         ///< what stands behind them, "" for nothing
};

/// Error: io (no journal).
objdb::Result<JournalText> parse_journal(std::string text);
/// Errors: io (no such file, no journal).
objdb::Result<JournalText> read_journal(const std::string& path);

/// The source of the records that close a tick: "tick N TIME HASH COUNT".
inline constexpr std::string_view tick_source = "tick";
/// The source of the records around what a program wrote down of its state: "NAME" before, "NAME done" after.
inline constexpr std::string_view checkpoint_source = "checkpoint";
/// The source of the record of a `rewind`: the time. What came after that time before it did not happen.
inline constexpr std::string_view rewind_source = "rewind";
/// The source of a command that was forwarded to a program: "NAME NUMBER LINE".
inline constexpr std::string_view ask_source = "ask";
/// The source of a command that was put off before the journal began: "ID START RUNS HELD LINE", or "ID" of the next.
inline constexpr std::string_view later_source = "later";

/// Nobody else may speak under these names.
inline bool is_source_of_manager(std::string_view name) {
  return name == tick_source || name == checkpoint_source || name == rewind_source || name == ask_source ||
         name == later_source || name == "main" || name == "schedule" || name == "manager";
}

}  // namespace manager
