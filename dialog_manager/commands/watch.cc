#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (call.session == nullptr) return call.error(-1, ErrorKind::busy, "a program declares what it reads instead");
  const Result<Target> target = parse_target(call.words[0]);
  if (!target) return target.error();
  if (!is_pattern(target->pattern)) {
    const Result<const Object*> object = find_object(call.manager.world, *target, call.scope);
    if (!object) return object.error();
    if (!target->field.empty() && !is_pattern(target->field))
      if (const Result<int> field = find_field(**object, target->field, target->field_column); !field)
        return field.error();
  }
  call.manager.watches.add(*call.session, std::string(call.words[0].text), call.scope);
  return {};
}

}  // namespace

extern const Command command_watch;
const Command command_watch = {
    "watch",
    "PATTERN[.FIELD]",
    "Tells every change of what fits as an event: after each tick, and after commands between ticks.",
    Effect::control,
    1,
    1,
    run};

}  // namespace manager
