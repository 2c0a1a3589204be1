#pragma once

#include "dialog_manager/command.h"
#include "dialog_manager/condition.h"

namespace manager {

/// Lets time pass up to a tick.
std::unique_ptr<Operation> advance_to(std::uint64_t tick);
/// Lets time pass until a condition holds; error timeout when it does not by `last_tick`.
std::unique_ptr<Operation> advance_until(Condition condition, std::uint64_t last_tick);

}  // namespace manager
