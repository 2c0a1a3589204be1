#include "dialog_manager/advance.h"
#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  std::size_t used = 0;
  Result<Condition> condition = Condition::parse(call.manager.world, call.words, call.scope, used);
  if (!condition) return condition.error();
  double duration = 60;
  if (used < call.words.size()) {
    if (call.words[used].text != "for" || used + 2 != call.words.size())
      return call.error(static_cast<int>(used), ErrorKind::syntax,
                        "unexpected " + quote(call.words[used].text) + ", expected for DURATION");
    const Result<double> said = real_word(call, used + 1, "s");
    if (!said) return said.error();
    if (!(*said >= 0 && *said <= 1e9))
      return call.error(static_cast<int>(used) + 1, ErrorKind::range,
                        "the duration is " + std::string(call.words[used + 1].text) + ", expected 0 to 1e9 s");
    duration = *said;
  }
  Clock& clock = call.manager.clock;
  clock.wake();
  return advance_until(call.source.id, std::move(*condition),
                       clock.tick() + clock.ticks_until(clock.time() + duration));
}

}  // namespace

extern const Command command_wait;
const Command command_wait = {"wait",
                              "CONDITION [for DURATION]",
                              "Lets time pass until FIELD OP VALUE [+- TOL] holds; error timeout when it does not "
                              "within the duration (60s when not said).",
                              Effect::time,
                              3,
                              any_number,
                              run};

}  // namespace manager
