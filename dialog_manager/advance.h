#pragma once

#include "dialog_manager/command.h"
#include "dialog_manager/condition.h"

namespace manager {

/// Lets time pass up to a tick, for a source: error busy when time was paused by itself, which cannot say resume while
/// it waits, or by a command kept for later.
std::unique_ptr<Operation> advance_to(std::uint16_t source, std::uint64_t tick);
/// The same up to a tick though time is paused.
std::unique_ptr<Operation> step_to(std::uint64_t tick);
/// As advance_to, until a condition holds; error timeout when it does not by `last_tick`.
std::unique_ptr<Operation> advance_until(std::uint16_t source, Condition condition, std::uint64_t last_tick);

}  // namespace manager
