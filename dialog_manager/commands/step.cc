#include "dialog_manager/advance.h"
#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<std::uint64_t> count = count_word(call, 0, 1);
  if (!count) return count.error();
  call.manager.clock.wake();
  return step_to(call.manager.clock.tick() + *count);
}

}  // namespace

extern const Command command_step;
const Command command_step = {
    "step", "[N]", "Lets N ticks pass, 1 when not said; also while time is paused.", Effect::time, 0, 1, run};

}  // namespace manager
