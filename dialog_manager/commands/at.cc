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
    print_entries(call.out, schedule, Schedule::Entry::Kind::at);
    return {};
  }
  const Result<double> time = real_word(call, 0, "s");
  if (!time) return time.error();
  if (*time < call.manager.clock.time() - 1e-9)
    return call.error(0, ErrorKind::range,
                      "the time is " + std::string(call.words[0].text) + ", which is past, expected " +
                          number(call.manager.clock.time()) + "s or later");
  if (call.words.size() < 2) return call.error(0, ErrorKind::syntax, "expected at TIME COMMAND");
  Result<Schedule::Entry> entry = command_for_later(call, 1);
  if (!entry) return entry.error();
  entry->kind = Schedule::Entry::Kind::at;
  entry->time = *time;
  schedule.add(std::move(*entry));
  return {};
}

}  // namespace

extern const Command command_at;
const Command command_at = {
    "at",
    "TIME COMMAND",
    "Runs a command when simulated time has come to TIME; without words prints what is to come.",
    Effect::control,
    0,
    any_number,
    run};

}  // namespace manager
