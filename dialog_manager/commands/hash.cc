#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  append_hexadecimal(call.out, call.manager.hash());
  call.out += '\n';
  return {};
}

}  // namespace

extern const Command command_hash;
const Command command_hash = {
    "hash",
    "",
    "Prints 64 bits over the whole world, 16 hexadecimal digits. Private and measured fields do not count.",
    Effect::look,
    0,
    0,
    run};

}  // namespace manager
