#include "dialog_manager/replay.h"

#include "dialog_manager/command.h"
#include "dialog_manager/live_replay.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Manager& manager = call.manager;
  const bool live = call.words.size() == 2;
  const int file = live && call.words[0].text == "--live" ? 1 : 0;
  if (live && call.words[static_cast<std::size_t>(1 - file)].text != "--live")
    return call.error(1, ErrorKind::syntax, "expected replay [--live] FILE");
  const std::string path(call.words[static_cast<std::size_t>(file)].text);
  Result<JournalText> text = read_journal(path);
  if (!text) return call.error(file, text.error().kind, text.error().sentence);
  if (manager.world.size() > 0 || !manager.programs.all().empty())
    return call.error(-1, ErrorKind::exists,
                      "the world has " + std::to_string(manager.world.size()) + " objects, expected an empty one");
  if (!manager.schedule.entries().empty())
    return call.error(-1, ErrorKind::exists,
                      std::to_string(manager.schedule.entries().size()) + " commands are put off, expected none");
  // the numbers of those that the journal puts off count from 1
  manager.schedule.clear();
  if (!text->flaw.empty())
    manager.event("event journal " + path + " " + text->flaw + "; what stands before it is taken up");
  text->records = records_until(std::move(text->records), text->start, 1e300);
  return live ? live_replay(std::move(*text)) : replay(std::move(*text), false);
}

}  // namespace

extern const Command command_replay;
const Command command_replay = {
    "replay",
    "[--live] FILE",
    "Makes the world of a journal again in an empty world, without its programs; the hash is checked at every tick. "
    "With --live its programs run again, and the first field that differs is named.",
    Effect::time,
    1,
    2,
    run};

}  // namespace manager
