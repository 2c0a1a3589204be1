#pragma once

#include "dialog_manager/command.h"
#include "dialog_manager/journal.h"

namespace manager {

/// Does a journal keep this line, so that the world can be made again from it?
bool is_journaled(const Command& command);

/// Carries out the records of a journal. Without programs, what they said is taken from the journal; with `live`, they
/// are started again and told what they were told then, so that they can go on where they were.
/// The hash is checked at every tick: error range at the first that differs.
std::unique_ptr<Operation> replay(JournalText text, bool live);

/// The records up to a time, with what `rewind` records took back left out.
std::vector<Record> records_until(const JournalText& text, double time);

}  // namespace manager
