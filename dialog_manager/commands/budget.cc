#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  using Of = Budget::Of;
  if (call.words.empty()) {
    call.out += call.manager.budget().line().substr(7) + "\n";
    return {};
  }
  const std::string_view word = call.words[0].text;
  if (word == "off" && call.words.size() == 1) {
    call.manager.set_budget({});
    return {};
  }
  if ((word != "error" && word != "time") || call.words.size() != 2)
    return call.error(0, ErrorKind::syntax, "expected budget error X, budget time X or budget off");
  // an error may be a length or an angle
  Result<double> value = real_word(call, 1, word == "time" ? "s" : "m");
  if (!value && word == "error") value = real_word(call, 1, "rad");
  if (!value) return value.error();
  if (!(*value > 0))
    return call.error(1, ErrorKind::range,
                      "the budget is " + std::string(call.words[1].text) + ", expected more than 0");
  call.manager.set_budget({word == "time" ? Of::time : Of::error, *value});
  return {};
}

}  // namespace

extern const Command command_budget;
const Command command_budget = {"budget",
                                "[error X|time X|off]",
                                "Tells the programs what the scene wants: at most this error, or this time a tick; "
                                "those with method auto choose by it. Without words prints it.",
                                Effect::control,
                                0,
                                2,
                                run};

}  // namespace manager
