#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  for (const auto& each : call.manager.programs.all()) {
    const auto add = [&](std::string_view name, std::string_view value) {
      call.out.append(" ").append(name).append("=").append(value);
    };
    call.out += each->name + " " + std::string(each->state_name());
    add("pid", std::to_string(each->pid()));
    add("stage", std::to_string(each->stage));
    add("rate", number(each->rate() > 0 ? each->rate() : call.manager.clock.rate()));
    add("ms", number(each->last_ms()));
    add("queue", std::to_string(each->queued()));
    add("asked", std::to_string(each->asked()));
    add("refused", std::to_string(each->refused()));
    add("restarts", std::to_string(each->restarts()));
    add("checkpoint", std::to_string(each->checkpoint_tick()));
    add("log", std::to_string(each->log_bytes()));
    // what everybody waits for
    if (each->waiting() > 0) add("blocking", number(each->waiting()) + "s");
    if (each->state() == Manipulator::State::failed) add("reason", "\"" + each->failure().sentence + "\"");
    call.out += "\n";
  }
  return {};
}

}  // namespace

extern const Command command_manipulators;
const Command command_manipulators = {
    "manipulators",
    "",
    "Prints the programs: name, state, process, stage, rate (Hz), milliseconds of the last tick, bytes queued for it, "
    "commands it has not answered, lines of it that were refused, restarts, tick of its last checkpoint, bytes that a "
    "restart would tell it, and for how long it keeps everybody waiting.",
    Effect::look,
    0,
    0,
    run};

}  // namespace manager
