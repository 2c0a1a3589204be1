#include "dialog_manager/schedule.h"

#include <algorithm>

namespace manager {
namespace {

// a time within rounding of a tick is that tick
constexpr double rounding = 1e-9;

}  // namespace

int Schedule::add(Entry entry) {
  entry.id = next_id_++;
  entries_.push_back(std::move(entry));
  return entries_.back().id;
}

void Schedule::restore(int id, double start, std::uint64_t runs, bool held) {
  Entry& entry = entries_.back();
  next_id_ = id + 1;
  entry.id = id;
  entry.held = held;
  if (entry.kind != Entry::Kind::every) return;
  entry.start = start;
  entry.runs = runs;
  entry.time = start + static_cast<double>(runs + 1) * entry.period;
}

std::string Schedule::say(const Entry& entry) {
  std::string out(entry.kind == Entry::Kind::at ? "at " : entry.kind == Entry::Kind::every ? "every " : "when ");
  if (entry.kind == Entry::Kind::when)
    out += entry.condition->text();
  else
    objdb::append_number(out, entry.kind == Entry::Kind::at ? entry.time : entry.period);
  return out + " " + objdb::quote(entry.command);
}

bool Schedule::forget(int id) {
  return std::erase_if(entries_, [&](const Entry& entry) { return entry.id == id; }) > 0;
}

std::vector<Schedule::Entry> Schedule::take_due(double time, const objdb::Database& world) {
  std::vector<Entry> due;
  for (Entry& entry : entries_) {
    if (entry.kind == Entry::Kind::when) {
      // it fires when its condition becomes true; an object that is gone makes it false
      const objdb::Result<bool> holds = entry.condition->holds(world);
      const bool now = holds && *holds;
      if (now && !entry.held) due.push_back(entry);
      entry.held = now;
    } else if (entry.time <= time + rounding) {
      due.push_back(entry);
      if (entry.kind == Entry::Kind::at) continue;
      // a period shorter than a tick runs once a tick; the times are computed, never summed
      while (entry.time <= time + rounding)
        entry.time = entry.start + static_cast<double>(++entry.runs + 1) * entry.period;
    }
  }
  std::erase_if(entries_,
                [&](const Entry& entry) { return entry.kind == Entry::Kind::at && entry.time <= time + rounding; });
  return due;
}

}  // namespace manager
