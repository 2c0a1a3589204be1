#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Clock& clock = call.manager.clock;
  if (call.words.empty()) {
    call.out += clock.pace() <= 0 ? "fast" : clock.pace() == 1 ? "realtime" : number(clock.pace());
    call.out += '\n';
    return {};
  }
  const std::string_view word = call.words[0].text;
  if (word == "fast" || word == "realtime") {
    clock.set_pace(word == "fast" ? 0 : 1);
    return {};
  }
  const Result<double> pace = real_word(call, 0, "");
  if (!pace) return call.error(0, ErrorKind::type, quote(word) + " is no pace, expected fast, realtime or a number");
  if (!Clock::is_pace(*pace))
    return call.error(0, ErrorKind::range, "the pace is " + std::string(word) + ", expected 1e-6 to 1e6");
  clock.set_pace(*pace);
  return {};
}

}  // namespace

extern const Command command_pace;
const Command command_pace = {"pace",
                              "[fast|realtime|X]",
                              "Sets how fast simulated time passes: as fast as it goes, as the wall clock, or X times "
                              "as fast; without a word prints it.",
                              Effect::control,
                              0,
                              1,
                              run};

}  // namespace manager
