#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (call.session == nullptr) return call.error(-1, ErrorKind::busy, "a program has no transaction");
  if (Status status = call.manager.history.roll_back(*call.session); !status)
    return call.error(-1, status.error().kind, status.error().sentence);
  return {};
}

}  // namespace

extern const Command command_rollback;
const Command command_rollback = {
    "rollback", "", "Ends a transaction and takes back what it changed.", Effect::control, 0, 0, run};

}  // namespace manager
