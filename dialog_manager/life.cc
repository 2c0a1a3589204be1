#include "dialog_manager/life.h"

#include <cassert>
#include <cstddef>
#include <optional>

namespace manager {
namespace {

using State = Life::State;
using Step = std::optional<State>;

constexpr std::size_t states = 7, events = 6;
constexpr Step none;

// what was given up may be asked to end, and what has ended too; a program that dies before it was ready is given up
constexpr Step next[states][events] = {
    //               launched            declared      briefed        lost               ended         given_up
    /* starting   */ {State::handshaking, none, none, none, State::ended, State::failed},
    /* handshaking*/ {none, State::ready, none, State::restarting, State::ended, State::failed},
    /* ready      */ {none, none, State::active, none, State::ended, State::failed},
    /* active     */ {none, none, none, State::restarting, State::ended, State::failed},
    /* restarting */ {State::handshaking, none, none, none, State::ended, State::failed},
    /* ended      */ {none, none, none, none, State::ended, none},
    /* failed     */ {none, none, none, none, State::ended, State::failed},
};

constexpr std::string_view names[states] = {"starting",   "handshaking", "ready", "active",
                                            "restarting", "ended",       "failed"};

}  // namespace

std::string_view Life::name() const { return names[static_cast<std::size_t>(state_)]; }

void Life::take(Event event) {
  const Step step = next[static_cast<std::size_t>(state_)][static_cast<std::size_t>(event)];
  assert(step.has_value());
  if (step) state_ = *step;
}

}  // namespace manager
