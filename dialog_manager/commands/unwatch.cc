#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  if (call.session != nullptr) call.manager.watches.remove(*call.session);
  return {};
}

}  // namespace

extern const Command command_unwatch;
const Command command_unwatch = {"unwatch", "", "Watches nothing any more.", Effect::control, 0, 0, run};

}  // namespace manager
