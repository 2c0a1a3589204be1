#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (call.words.empty()) {
    append_number(call.out, call.manager.clock.rate());
    call.out += '\n';
    return {};
  }
  const Result<double> rate = real_word(call, 0, "Hz");
  if (!rate) return rate.error();
  if (!(*rate >= 1e-3 && *rate <= 1e6))
    return call.error(0, ErrorKind::range,
                      "the rate is " + std::string(call.words[0].text) + ", expected 0.001 to 1e6 Hz");
  call.manager.clock.set_rate(*rate);
  return {};
}

}  // namespace

extern const Command command_rate;
const Command command_rate = {
    "rate",
    "[HZ]",
    "Sets how many ticks a simulated second has (60 at the start); without a number prints it.",
    Effect::control,
    0,
    1,
    run};

}  // namespace manager
