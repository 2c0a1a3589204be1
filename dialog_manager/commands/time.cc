#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  append_number(call.out, call.manager.clock.time());
  call.out += '\n';
  return {};
}

}  // namespace

extern const Command command_time;
const Command command_time = {"time", "", "Prints the simulated time in seconds.", Effect::look, 0, 0, run};

}  // namespace manager
