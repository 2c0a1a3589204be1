#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (Status status = call.manager.speakers.unlisten(std::string(call.words[0].text)); !status)
    return call.error(0, status.error().kind, status.error().sentence);
  return {};
}

}  // namespace

extern const Command command_unlisten;
const Command command_unlisten = {"unlisten", "FIFO", "Takes no more commands from a FIFO.", Effect::control, 1,
                                  1,          run};

}  // namespace manager
