#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Manager& manager = call.manager;
  const std::string path(call.words[0].text);
  if (call.words.size() == 1) {
    if (!manager.end_trace(path)) return call.error(0, ErrorKind::unknown, "no trace is written to " + path);
    return {};
  }
  Words patterns = call.words.subspan(1);
  double period = 0;
  if (patterns.size() >= 2 && patterns[patterns.size() - 2].text == "every") {
    const Result<double> said = real_word(call, call.words.size() - 1, "s");
    if (!said) return said.error();
    if (!(*said > 0))
      return call.error(static_cast<int>(call.words.size()) - 1, ErrorKind::range,
                        "the period is " + std::string(call.words.back().text) + ", expected more than 0");
    period = *said;
    patterns = patterns.first(patterns.size() - 2);
  }
  if (patterns.empty()) return call.error(0, ErrorKind::syntax, "expected trace FILE.csv PATTERN... [every DT]");
  manager.end_trace(path);
  Result<std::unique_ptr<Trace>> trace =
      Trace::open(path, manager.world, patterns, call.scope, manager.clock.time(), period);
  if (!trace)
    return trace.error().column == 0 ? call.error(0, trace.error().kind, trace.error().sentence) : trace.error();
  manager.add_trace(std::move(*trace));
  return {};
}

}  // namespace

extern const Command command_trace;
const Command command_trace = {"trace",
                               "FILE.csv [PATTERN[.FIELD]... [every DT]]",
                               "Writes values over simulated time: a header with units, t first, a row now and after "
                               "every tick or every DT. Without a pattern the file is closed.",
                               Effect::control,
                               1,
                               any_number,
                               run};

}  // namespace manager
