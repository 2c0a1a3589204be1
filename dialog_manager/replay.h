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

/// What a tick's closing record says.
struct TickLine {
  std::uint64_t tick = 0;
  double time = 0;
  std::uint64_t hash = 0;
};

std::optional<TickLine> parse_tick(const Record& record);

/// Carries out the line of a record, as whoever said it. `journal`: the file it stands in, which arrays stand beside.
/// `owning`: a program that runs becomes the owner of what it wrote.
Outcome say_again(Manager& manager, const Record& record, const std::string& journal, bool owning);
/// The same, of a line that was split already.
Outcome say_again(Manager& manager, const Record& record, const objdb::LineWords& words, const std::string& journal,
                  bool owning);

/// The records of a journal that begins so, up to a time, with what `rewind` records took back left out.
std::vector<Record> records_until(std::vector<Record> records, const JournalStart& start, double time);

}  // namespace manager
