#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (!call.manager.paused()) {
    call.manager.clock.wake();
    call.manager.run_free(true);
  }
  call.manager.go_on();
  return {};
}

}  // namespace

extern const Command command_resume;
const Command command_resume = {
    "resume",
    "",
    "Lets time go on after pause; when nothing was paused, lets it flow by itself until pause.",
    Effect::control,
    0,
    0,
    run};

}  // namespace manager
