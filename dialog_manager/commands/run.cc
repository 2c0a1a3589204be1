#include "dialog_manager/advance.h"
#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<double> duration = real_word(call, 0, "s");
  if (!duration) return duration.error();
  if (!(*duration >= 0 && *duration <= 1e9))
    return call.error(0, ErrorKind::range,
                      "the duration is " + std::string(call.words[0].text) + ", expected 0 to 1e9 s");
  Clock& clock = call.manager.clock;
  clock.wake();
  return advance_to(call.source.id, clock.tick() + clock.ticks_until(clock.time() + *duration));
}

}  // namespace

extern const Command command_run;
const Command command_run = {"run", "DURATION", "Lets simulated time pass: 2s, 500ms.", Effect::time, 1, 1, run};

}  // namespace manager
