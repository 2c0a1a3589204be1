#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  for (std::size_t i = 0; i < call.words.size(); ++i) call.out.append(i == 0 ? "" : " ").append(call.words[i].text);
  call.out += '\n';
  return {};
}

}  // namespace

extern const Command command_echo;
const Command command_echo = {"echo", "TEXT...", "Prints its words.", Effect::look, 0, any_number, run};

}  // namespace manager
