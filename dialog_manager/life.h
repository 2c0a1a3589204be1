#pragma once

#include <string_view>

namespace manager {

/// Where a program stands. The one table of what leads where is in life.cc.
class Life {
 public:
  enum class State { starting, handshaking, ready, active, restarting, ended, failed };
  enum class Event {
    launched,  ///< its process runs
    declared,  ///< it said ready, and its declarations hold
    briefed,   ///< it has been told what it reads
    lost,      ///< its process died, and another is to follow
    ended,     ///< it ended as it was asked to
    given_up,  ///< it cannot be kept alive
  };

  State state() const { return state_; }
  std::string_view name() const;
  /// An event that cannot come in this state is a mistake of our own, and asserts.
  void take(Event event);

  bool is(State state) const { return state_ == state; }
  /// It will not take part any more, until it is started anew.
  bool over() const { return is(State::ended) || is(State::failed); }

 private:
  State state_ = State::starting;
};

}  // namespace manager
