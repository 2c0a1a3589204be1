#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (Status status = call.manager.speakers.listen(std::string(call.words[0].text)); !status)
    return call.error(0, status.error().kind, status.error().sentence);
  return {};
}

}  // namespace

extern const Command command_listen;
const Command command_listen = {
    "listen",
    "FIFO",
    "Takes commands from a FIFO too; it is made, mode 0600, when it is not there. Lines are at most 4096 bytes.",
    Effect::control,
    1,
    1,
    run};

}  // namespace manager
