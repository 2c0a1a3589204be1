#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<ObjectId> id = create_statement(call.manager.world, call.words, call.scope);
  if (!id) return id.error();
  // a refusal takes it back
  if (call.source.gate != nullptr)
    if (Status may = call.source.gate->may_make(*call.manager.world.object(*id)); !may)
      return call.error(1, may.error().kind, may.error().sentence);
  return {};
}

}  // namespace

extern const Command command_create;
const Command command_create = {
    "create", "TYPE PATH {FIELD VALUE...}", "Creates an object; a/b needs a.", Effect::change, 2, any_number, run};

}  // namespace manager
