#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  for (const std::string& name : call.manager.sources()) call.out += name + "\n";
  return {};
}

}  // namespace

extern const Command command_sources;
const Command command_sources = {
    "sources", "", "Prints who can speak: the main conversation, FIFOs, programs.", Effect::look, 0, 0, run};

}  // namespace manager
