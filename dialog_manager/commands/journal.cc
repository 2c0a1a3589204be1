#include <algorithm>

#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/written_down.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Manager& manager = call.manager;
  if (call.words.empty()) {
    if (manager.recorder.journal() != nullptr) call.out += manager.recorder.journal()->path() + "\n";
    return {};
  }
  if (manager.history.in_transaction())
    return call.error(-1, ErrorKind::busy, "a transaction is open, expected commit or rollback");
  if (call.words.size() == 1 && call.words[0].text == "off" && !call.words[0].quoted) {
    manager.recorder.end();
    return {};
  }
  static constexpr std::string_view policies[] = {"none", "everysec", "tick", "always"};
  auto sync = Journal::Sync::everysec;
  if (call.words.size() == 2) {
    const auto found = std::find(std::begin(policies), std::end(policies), call.words[1].text);
    if (found == std::end(policies))
      return call.error(1, ErrorKind::type,
                        shown(call.words[1].text) + " is no policy, expected none, everysec, tick or always");
    sync = static_cast<Journal::Sync>(found - std::begin(policies));
  }
  const auto begin = [path = std::string(call.words[0].text), column = call.words[0].column, sync](
                         Manager& all, std::string&) -> Status {
    Status begun = all.recorder.begin(path, sync);
    return begun ? begun : Error{begun.error().kind, begun.error().sentence, column};
  };
  return with_written_down(manager, call.out, begin);
}

}  // namespace

extern const Command command_journal;
const Command command_journal = {
    "journal",
    "[FILE [none|everysec|tick|always]] | off",
    "Keeps every accepted line in a file, after the world as it stands: from it the world can be made again (replay, "
    "--resume). The word says when the disk is waited for. Without words prints the file.",
    Effect::control,
    0,
    2,
    run};

}  // namespace manager
