#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (call.session == nullptr) return call.error(-1, ErrorKind::busy, "a program cannot monitor");
  const std::string_view word = call.words.empty() ? std::string_view("on") : call.words[0].text;
  if (word != "on" && word != "off") return call.error(0, ErrorKind::syntax, "expected monitor on or off");
  call.manager.dispatch.monitor_for(word == "on" ? call.session : nullptr);
  return {};
}

}  // namespace

extern const Command command_monitor;
const Command command_monitor = {
    "monitor", "[on|off]", "Tells every accepted line, with who said it, as an event.", Effect::control, 0, 1, run};

}  // namespace manager
