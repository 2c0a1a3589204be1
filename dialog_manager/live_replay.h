#pragma once

#include "dialog_manager/command.h"
#include "dialog_manager/journal.h"

namespace manager {

/// Carries out what people and scripts said in a journal, and lets its programs compute everything again. The hash is
/// compared at every tick; at the first that differs the end is error range, which names the tick and the first field
/// with both values. At the end the programs go on from there.
std::unique_ptr<Operation> live_replay(JournalText text);

}  // namespace manager
