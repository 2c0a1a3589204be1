#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<const Field*> field = call.manager.world.declare_field(call.words);
  if (!field) return field.error();
  call.manager.programs.schema_changed();
  return {};
}

}  // namespace

extern const Command command_field;
const Command command_field = {
    "field",
    "TYPE.NAME KIND [UNIT] [= VALUE...] [in LO HI] [of WORD WORD ...] [private|measured] [\"doc\"]",
    "Declares a field of a type; objects that exist get its default. KIND: bool int real vec3 quat word text ref "
    "ref:TYPE, with [] or [n] for arrays.",
    Effect::change,
    2,
    any_number,
    run};

}  // namespace manager
