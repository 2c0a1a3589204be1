#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  for (const auto& type : call.manager.world.schema().types())
    call.out += type->name() + (type->base() == nullptr ? "" : " extends " + type->base()->name()) + "\n";
  return {};
}

}  // namespace

extern const Command command_types;
const Command command_types = {"types", "", "Prints the types that are known and what they extend.", Effect::look, 0,
                               0,       run};

}  // namespace manager
