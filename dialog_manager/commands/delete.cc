#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) { return delete_statement(call.manager.world, call.words, call.scope); }

}  // namespace

extern const Command command_delete;
const Command command_delete = {
    "delete",
    "PATTERN [force]",
    "Deletes objects and everything below them. What others refer to is kept, unless force empties their references.",
    Effect::change,
    1,
    2,
    run};

}  // namespace manager
