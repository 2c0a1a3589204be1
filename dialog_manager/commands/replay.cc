#include "dialog_manager/replay.h"
#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Manager& manager = call.manager;
  Result<JournalText> text = read_journal(std::string(call.words[0].text));
  if (!text) return call.error(0, text.error().kind, text.error().sentence);
  if (manager.world.size() > 0 || !manager.manipulators().empty())
    return call.error(-1, ErrorKind::exists,
                      "the world has " + std::to_string(manager.world.size()) + " objects, expected an empty one");
  if (!text->flaw.empty())
    manager.event("event journal " + std::string(call.words[0].text) + " " + text->flaw +
                  "; what stands before it is taken up");
  text->records = records_until(*text, 1e300);
  return replay(std::move(*text), false);
}

}  // namespace

extern const Command command_replay;
const Command command_replay = {
    "replay",
    "FILE",
    "Makes the world of a journal again in an empty world, without its programs; the hash is checked at every tick.",
    Effect::time,
    1,
    1,
    run};

}  // namespace manager
