#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "dialog_manager/manager.h"

namespace manager {

/// A command that is to find the private state of the programs in the world: they write it down first, then `act` is
/// carried out; at once, when there is nobody to ask. `Act`: Status(Manager&, std::string& out).
template <class Act>
Outcome with_written_down(Manager& manager, std::string& out, Act act) {
  class WrittenDown : public Operation {
   public:
    explicit WrittenDown(Act last) : act_(std::move(last)) {}
    std::optional<objdb::Status> poll(Manager& world, std::string& body) override {
      if (!world.resting()) return std::nullopt;
      return act_(world, body);
    }

   private:
    Act act_;
  };
  manager.write_down(nullptr);
  if (manager.resting()) return act(manager, out);
  return std::make_unique<WrittenDown>(std::move(act));
}

}  // namespace manager
