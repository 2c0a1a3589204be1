#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  static constexpr char digits[] = "0123456789abcdef";
  const std::uint64_t hash = call.manager.hash();
  for (int shift = 60; shift >= 0; shift -= 4) call.out += digits[(hash >> shift) & 15];
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
