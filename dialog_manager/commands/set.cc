#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) { return set_statement(call.manager.world, call.words, call.scope, call.source.gate); }

}  // namespace

extern const Command command_set;
const Command command_set = {
    "set",
    "PATTERN.FIELD VALUE...",
    "Sets a field, of one object or of all that fit; FIELD[3] and FIELD[0..9] are elements of an array.",
    Effect::change,
    2,
    any_number,
    run};

}  // namespace manager
