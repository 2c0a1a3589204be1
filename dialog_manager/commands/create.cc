#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<ObjectId> id = create_statement(call.manager.world, call.words, call.scope);
  return id ? Outcome() : Outcome(id.error());
}

}  // namespace

extern const Command command_create;
const Command command_create = {
    "create", "TYPE PATH {FIELD VALUE...}", "Creates an object; a/b needs a.", Effect::change, 2, any_number, run};

}  // namespace manager
