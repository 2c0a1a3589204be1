#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "dialog_manager/channel/line_buffer.h"

/// Lines over descriptors, on epoll (docs/decisions/0006-four-system-calls.md). One thread; nothing blocks.
namespace channel {

using Clock = std::chrono::steady_clock;
class Watch;

/// Waits for descriptors, child processes and signals.
class Loop {
 public:
  Loop();
  ~Loop();
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  /// Handles what is ready; when nothing is, waits for the first thing to happen, at the longest until `deadline`.
  void wait(std::optional<Clock::time_point> deadline);
  /// Handles what is ready.
  void poll();
  /// Calls `handler` when one of these signals arrives.
  void on_signal(std::initializer_list<int> signals, std::function<void(int)> handler);

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Whose a descriptor is. The flags of a `shared` one (standard input, a terminal) belong to other programs too: they
/// are never changed, and it is not closed. An `own` one is non-blocking and closed at the end.
enum class Descriptor { own, shared };

/// Reads a descriptor into a LineBuffer, as far as somebody takes the lines out: a writer that floods is left waiting.
class Reader {
 public:
  Reader(Loop& loop, int descriptor, Descriptor kind, std::size_t longest_line);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Asks for more bytes, when the buffer has no whole line left; the first ones come unasked. Cheap to call again.
  void want();
  LineBuffer& lines() { return lines_; }
  /// It could not be watched: too many descriptors are open. It is at its end.
  bool failed() const { return failed_; }
  /// The end of the stream was reached (or reading failed).
  bool at_end() const { return lines_.closed(); }

 private:
  void ready();
  void read();

  LineBuffer lines_;
  int descriptor_;
  Descriptor kind_;
  std::unique_ptr<Watch> watch_;
  bool wanted_ = true;
  bool failed_ = false;
};

/// Writes to a descriptor without ever waiting: what does not fit is kept, up to a limit. One Writer a descriptor.
class Writer {
 public:
  Writer(Loop& loop, int descriptor, Descriptor kind);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Where to append; flush() sends it on.
  std::string& buffer() { return buffer_; }
  void write(std::string_view text) { buffer_ += text; }
  /// Hands over as much as the descriptor takes now; the rest follows when it takes more.
  void flush();
  /// Waits until everything is written, at the longest `limit`. For the last words before an end.
  void drain(std::chrono::milliseconds limit);
  /// Drops what waits.
  void discard();
  /// Bytes that wait.
  std::size_t pending() const { return buffer_.size() - written_; }
  /// The reader is gone (EPIPE) or the descriptor failed; what is written from now on is dropped.
  bool broken() const { return broken_; }
  /// The errno of what broke it, 0 when it is whole.
  int failure() const { return failure_; }

 private:
  void send();
  ssize_t write_some(std::string_view bytes) const;

  std::string buffer_;
  std::size_t written_ = 0;
  bool broken_ = false;
  int failure_ = 0;
  bool waiting_ = false;
  int descriptor_;
  bool own_, socket_ = false;
  std::unique_ptr<Watch> watch_;
};

/// Calls `handler` when a shared descriptor has something to read, each time want() asked for it.
class ReadyWatch {
 public:
  ReadyWatch(Loop& loop, int descriptor, std::function<void()> handler);
  ~ReadyWatch();
  void want();

 private:
  std::unique_ptr<Watch> watch_;
};

/// Calls `handler` once, when the process of this pidfd has ended. Closes the pidfd.
class ExitWatch {
 public:
  ExitWatch(Loop& loop, int pidfd, std::function<void()> handler);
  ~ExitWatch();

 private:
  int pidfd_;
  std::unique_ptr<Watch> watch_;
};

}  // namespace channel
