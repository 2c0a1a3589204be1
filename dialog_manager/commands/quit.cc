#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  call.manager.quit();
  return {};
}

}  // namespace

extern const Command command_quit;
const Command command_quit = {"quit", "", "Ends the programs and the manager.", Effect::control, 0, 0, run};

}  // namespace manager
