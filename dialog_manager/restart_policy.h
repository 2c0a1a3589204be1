#pragma once

#include <chrono>
#include <deque>

namespace manager {

/// When a program that died is started again: at once, then after 50 ms, when it died again without having finished a
/// tick. Not any more when it died so three times in a row, was started more than 5 times in 10 s, or when two lives in
/// a row ended because they talked garbage.
class RestartPolicy {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// It was started, for the first time or again.
  void started(Time now) { starts_.push_back(now); }
  /// It did what it is there for.
  void finished() { strikes_ = 0; }
  enum class Verdict {
    again,       ///< it is started again, at `when`
    struck_out,  ///< it dies of what it is told
    too_often,   ///< whatever it is told
  };
  struct Sentence {
    Verdict verdict;
    Time when;
  };
  /// It died, or was ended because it talked `garbage`.
  Sentence died(Time now, bool garbage);
  /// Deaths since it last finished a tick.
  int strikes() const { return strikes_; }

 private:
  std::deque<Time> starts_;  // in the last 10 s
  int strikes_ = 0;
  int garbage_ = 0;  // lives in a row that talked it
};

}  // namespace manager
