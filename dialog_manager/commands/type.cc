#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  const Result<const Type*> type = call.manager.world.declare_type(call.words);
  if (!type) return type.error();
  call.manager.programs.schema_changed();
  return {};
}

}  // namespace

extern const Command command_type;
const Command command_type = {"type",
                              "NAME [extends BASE] [\"doc\"]",
                              "Declares a type of objects. Saying the same again changes nothing.",
                              Effect::change,
                              1,
                              any_number,
                              run};

}  // namespace manager
