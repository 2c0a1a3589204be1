#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace manager {

/// How far long work has come: one line on a terminal, written over as the work goes on and wiped away at its end.
/// Silent where the descriptor is no terminal, and about work that is done within a second.
class Progress {
 public:
  using Wall = std::chrono::steady_clock;

  explicit Progress(int descriptor);

  /// Work is under way: this much of it is done, from 0 to 1; nothing when nobody knows. `what` follows: who is waited
  /// for. Cheap to call again.
  template <class Share, class What>
  void work(Share share, What what) {
    if (!terminal_ || !due()) return;
    show(share(), what());
  }
  /// Wipes the line away, so that something else can be printed.
  void clear();
  /// The work is done.
  void rest();
  /// When the line wants to be written again.
  std::optional<Wall::time_point> next() const;

 private:
  bool due();
  void show(std::optional<double> share, const std::string& what);

  int descriptor_;
  bool terminal_;
  bool working_ = false, shown_ = false;
  Wall::time_point since_{}, next_{};
  double first_share_ = 0;  // when the work was first seen
};

}  // namespace manager
