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
    print_entries(call.out, schedule, Schedule::Entry::Kind::when);
    return {};
  }
  std::size_t used = 0;
  Result<Condition> condition = Condition::parse(call.manager.world, call.words, call.scope, used);
  if (!condition) return condition.error();
  if (used == call.words.size())
    return call.error(static_cast<int>(used) - 1, ErrorKind::syntax, "expected when CONDITION COMMAND");
  Result<Schedule::Entry> entry = command_for_later(call, used);
  if (!entry) return entry.error();
  entry->kind = Schedule::Entry::Kind::when;
  entry->condition = std::move(*condition);
  schedule.add(std::move(*entry));
  return {};
}

}  // namespace

extern const Command command_when;
const Command command_when = {"when",
                              "CONDITION COMMAND",
                              "Runs a command each time a condition becomes true, looked at after every tick; without "
                              "words prints what is to come.",
                              Effect::control,
                              0,
                              any_number,
                              run};

}  // namespace manager
