#pragma once

#include <sys/epoll.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "dialog_manager/channel/loop.h"

namespace channel {

/// Calls `ready` whenever a descriptor is ready, as long as it is on: level-triggered, so that nothing is lost by
/// looking late. Flags of the descriptor are never touched: it may be shared with other programs.
class Watch {
 public:
  /// `events`: EPOLLIN or EPOLLOUT. On from the beginning. The descriptor must stay open as long as the watch.
  Watch(Loop::Impl& loop, int descriptor, std::uint32_t events, std::function<void()> ready);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  void on();
  void off();
  /// What cannot be watched because it never makes anyone wait: a regular file, /dev/null.
  bool always_ready() const { return always_ready_; }
  /// It could not be watched.
  bool failed() const { return failed_; }

 private:
  friend struct Loop::Impl;

  Loop::Impl& loop_;
  int descriptor_;
  std::uint32_t events_;
  std::function<void()> ready_;
  bool on_ = false, always_ready_ = false, failed_ = false;
};

/// The epoll instance, and signals as one more descriptor.
struct Loop::Impl {
  Impl();
  ~Impl();
  void wait(const timespec* limit);
  /// What happened to a watch that is gone is nobody's.
  void forget(const Watch& watch);

  int epoll = -1;
  int signals = -1;
  std::optional<Watch> signal_watch;
  std::array<epoll_event, 64> events{};
  std::span<epoll_event> happened;  // being handled
};

}  // namespace channel
