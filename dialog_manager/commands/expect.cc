#include "dialog_manager/command.h"
#include "dialog_manager/condition.h"
#include "dialog_manager/manager.h"
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  std::size_t used = 0;
  const Result<Condition> condition = Condition::parse(call.manager.world, call.words, call.scope, used);
  if (!condition) return condition.error();
  if (used < call.words.size())
    return call.error(static_cast<int>(used), ErrorKind::syntax, "unexpected " + quote(call.words[used].text));
  const Result<bool> holds = condition->holds(call.manager.world);
  if (!holds) return holds.error();
  if (!*holds) return call.error(0, ErrorKind::range, condition->failure(call.manager.world));
  return {};
}

}  // namespace

extern const Command command_expect;
const Command command_expect = {
    "expect",   "CONDITION", "Asserts FIELD OP VALUE [+- TOL]; error range when it does not hold.", Effect::look, 3,
    any_number, run};

}  // namespace manager
