#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  for (const auto& each : call.manager.manipulators()) {
    call.out += each->name + " " + std::string(each->state_name()) + " pid=" + std::to_string(each->pid()) +
                " stage=" + std::to_string(each->stage) +
                " rate=" + number(each->rate() > 0 ? each->rate() : call.manager.clock.rate()) +
                " ms=" + number(each->last_ms()) + " queue=" + std::to_string(each->queued()) +
                " restarts=" + std::to_string(each->restarts()) + (each->answering() ? " blocking" : "") + "\n";
  }
  return {};
}

}  // namespace

extern const Command command_manipulators;
const Command command_manipulators = {
    "manipulators",
    "",
    "Prints the programs: name, state, pid, stage, rate, milliseconds of the last tick, bytes queued, restarts.",
    Effect::look,
    0,
    0,
    run};

}  // namespace manager
