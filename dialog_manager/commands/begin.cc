#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (call.session == nullptr) return call.error(-1, ErrorKind::busy, "a program cannot open a transaction");
  if (call.session->input() != nullptr && call.session->input()->fifo)
    return call.error(-1, ErrorKind::busy,
                      "the lines of several writers mix on a FIFO: none of them can open a transaction");
  if (Status status = call.manager.history.begin(*call.session); !status)
    return call.error(-1, status.error().kind, status.error().sentence);
  return {};
}

}  // namespace

extern const Command command_begin;
const Command command_begin = {
    "begin",
    "",
    "Begins a transaction: what follows counts as one command, until commit or rollback. Time stands still meanwhile.",
    Effect::control,
    0,
    0,
    run};

}  // namespace manager
