#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  call.manager.pause(call.source);
  return {};
}

}  // namespace

extern const Command command_pause;
const Command command_pause = {
    "pause", "", "Stops time, also for a run that is under way, until resume; step goes on.", Effect::control, 0,
    0,       run};

}  // namespace manager
