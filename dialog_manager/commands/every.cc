#include "dialog_manager/command.h"
#include "dialog_manager/later.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Schedule& schedule = call.manager.schedule;
  if (call.words.empty()) {
    print_entries(call.out, schedule, Schedule::Entry::Kind::every);
    return {};
  }
  const Result<double> period = real_word(call, 0, "s");
  if (!period) return period.error();
  if (!(*period >= 1e-6))
    return call.error(0, ErrorKind::range,
                      "the period is " + std::string(call.words[0].text) + ", expected at least 1us");
  if (call.words.size() < 2) return call.error(0, ErrorKind::syntax, "expected every PERIOD COMMAND");
  Result<Schedule::Entry> entry = command_for_later(call, 1);
  if (!entry) return entry.error();
  entry->kind = Schedule::Entry::Kind::every;
  entry->start = call.manager.clock.time();
  entry->period = *period;
  entry->time = entry->start + entry->period;
  schedule.add(std::move(*entry));
  return {};
}

}  // namespace

extern const Command command_every;
const Command command_every = {
    "every",
    "PERIOD COMMAND",
    "Runs a command again and again, first when one period has passed; without words prints what is to come.",
    Effect::control,
    0,
    any_number,
    run};

}  // namespace manager
