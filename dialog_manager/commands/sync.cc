#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  call.out.append(call.words[0].text).append("\n");
  return {};
}

}  // namespace

extern const Command command_sync;
const Command command_sync = {
    "sync", "TOKEN", "Prints the token when everything said before has been done.", Effect::look, 1, 1, run};

}  // namespace manager
