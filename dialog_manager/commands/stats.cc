#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Manager& manager = call.manager;
  if (!call.words.empty()) {
    if (call.words[0].text != "reset") return call.error(0, ErrorKind::syntax, "expected stats [reset]");
    manager.counters = {};
    return {};
  }
  const auto line = [&](std::string_view name, std::uint64_t value) {
    call.out.append(name).append(" ").append(std::to_string(value)).append("\n");
  };
  line("objects", manager.world.size());
  line("types", manager.world.schema().types().size());
  line("lines", manager.counters.lines);
  line("ticks", manager.counters.ticks);
  line("manipulators", manager.programs.all().size());
  std::uint64_t restarts = 0;
  for (const auto& each : manager.programs.all()) restarts += static_cast<std::uint64_t>(each->restarts());
  line("restarts", restarts);
  return {};
}

}  // namespace

extern const Command command_stats;
const Command command_stats = {
    "stats", "[reset]", "Prints counters: objects, lines, ticks, programs, restarts.", Effect::look, 0, 1, run};

}  // namespace manager
