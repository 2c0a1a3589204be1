#pragma once

#include <chrono>
#include <deque>
#include <optional>

namespace manager {

/// When a program that died is started again: after 0, 50, 100, 200, 400 ms, the longer the more often it died without
/// finishing a tick. Not any more when it died so three times in a row, or was started more than 5 times in 10 s.
class RestartPolicy {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// It was started, for the first time or again.
  void started(Time now) { starts_.push_back(now); }
  /// It did what it is there for.
  void finished() { strikes_ = 0; }
  /// It died. When to start it again; nothing: it is given up.
  std::optional<Time> died(Time now);
  /// Deaths since it last finished a tick.
  int strikes() const { return strikes_; }

 private:
  std::deque<Time> starts_;  // in the last 10 s
  int strikes_ = 0;
};

}  // namespace manager
