#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<std::uint64_t> count = count_word(call, 0, 1);
  if (!count) return count.error();
  if (call.manager.history.in_transaction())
    return call.error(-1, ErrorKind::busy, "a transaction is open, expected rollback");
  if (Status status = call.manager.history.undo(*count); !status)
    return call.error(-1, status.error().kind, status.error().sentence);
  return {};
}

}  // namespace

extern const Command command_undo;
const Command command_undo = {
    "undo", "[N]", "Takes back the last N changing commands since the last tick.", Effect::control, 0, 1, run};

}  // namespace manager
