#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/number_word.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<std::uint64_t> id = count_word(call, 0, 1);
  if (!id) return id.error();
  if (!call.manager.schedule.forget(static_cast<int>(*id)))
    return call.error(0, ErrorKind::unknown, "nothing is put off under " + std::string(call.words[0].text));
  return {};
}

}  // namespace

extern const Command command_forget;
const Command command_forget = {
    "forget", "ID", "Forgets a command that at, every or when put off; they print their numbers.", Effect::control, 1,
    1,        run};

}  // namespace manager
