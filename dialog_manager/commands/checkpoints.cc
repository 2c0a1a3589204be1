#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Manager& manager = call.manager;
  if (call.words.empty()) {
    const Manager::Checkpoints& now = manager.checkpoints;
    call.out += now.ticks == 0 && now.bytes == 0
                    ? std::string("off\n")
                    : "every " + std::to_string(now.ticks) + " " + std::to_string(now.bytes) + "\n";
    return {};
  }
  if (call.words.size() == 1 && call.words[0].text == "now") {
    for (const auto& each : manager.programs.all()) each->want_checkpoint();
    return {};
  }
  if (call.words.size() == 1 && call.words[0].text == "off") {
    manager.checkpoints = {0, 0};
    return {};
  }
  if (call.words[0].text != "every" || call.words.size() < 2)
    return call.error(0, ErrorKind::syntax, "expected now, off, or every TICKS [BYTES]");
  Manager::Checkpoints every;
  for (std::size_t i = 1; i < call.words.size(); ++i) {
    const Result<std::int64_t> count = parse_integer(call.words[i].text);
    if (!count || *count < 1)
      return call.error(static_cast<int>(i), ErrorKind::range,
                        shown(call.words[i].text) + " is no count, expected 1 or more " + (i == 1 ? "ticks" : "bytes"));
    if (i == 1)
      every.ticks = static_cast<std::uint64_t>(*count);
    else
      every.bytes = static_cast<std::size_t>(*count);
  }
  manager.checkpoints = every;
  return {};
}

}  // namespace

extern const Command command_checkpoints;
const Command command_checkpoints = {
    "checkpoints",
    "[now | off | every TICKS [BYTES]]",
    "Has the programs write down their state before the next tick, or every so often: after so many ticks (60 unless "
    "said otherwise), or when a program was told so many bytes (16777216) since the last time. A restarted program is "
    "told that state and what came after it. Without words prints how often.",
    Effect::control,
    0,
    3,
    run};

}  // namespace manager
