#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<double> time = real_word(call, 0, "s");
  if (!time) return time.error();
  Outcome outcome = call.manager.playback.rewind(*time);
  if (!outcome.status) return call.error(0, outcome.status.error().kind, outcome.status.error().sentence);
  return outcome;
}

}  // namespace

extern const Command command_rewind;
const Command command_rewind = {"rewind",
                                "TIME",
                                "Goes back to a time of the journal; programs are started again and told what they "
                                "were told. What came after is kept in the journal, but no longer part of the story.",
                                Effect::time,
                                1,
                                1,
                                run};

}  // namespace manager
