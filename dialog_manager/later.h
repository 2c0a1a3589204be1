#pragma once

#include "dialog_manager/command.h"
#include "dialog_manager/schedule.h"

namespace manager {

/// The command that stands from word `index` on, as an entry of the schedule; checked as far as it can be before its
/// time: it is a line, its verb is known, and it does not make time pass.
objdb::Result<Schedule::Entry> command_for_later(const Call& call, std::size_t index);
/// Prints the entries of one kind: `ID WHEN COMMAND`.
void print_entries(std::string& out, const Schedule& schedule, Schedule::Entry::Kind kind);

}  // namespace manager
