#include "dialog_manager/advance.h"

#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

class AdvanceTo : public Operation {
 public:
  explicit AdvanceTo(std::uint64_t tick) : tick_(tick) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    if (manager.clock.tick() < tick_) return std::nullopt;
    return Status();
  }
  bool wants_tick(const Manager& manager) const override { return manager.clock.tick() < tick_; }

 private:
  std::uint64_t tick_;
};

class AdvanceUntil : public Operation {
 public:
  AdvanceUntil(Condition condition, std::uint64_t last_tick)
      : condition_(std::move(condition)), last_tick_(last_tick) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    const Result<bool> holds = condition_.holds(manager.world);
    if (!holds) return Status(holds.error());
    if (*holds) return Status();
    if (manager.clock.tick() < last_tick_) return std::nullopt;
    return Status(
        Error{ErrorKind::timeout, condition_.failure(manager.world) + " by " + number(manager.clock.time()) + " s", 0});
  }
  bool wants_tick(const Manager& manager) const override { return manager.clock.tick() < last_tick_; }

 private:
  Condition condition_;
  std::uint64_t last_tick_;
};

}  // namespace

std::unique_ptr<Operation> advance_to(std::uint64_t tick) { return std::make_unique<AdvanceTo>(tick); }

std::unique_ptr<Operation> advance_until(Condition condition, std::uint64_t last_tick) {
  return std::make_unique<AdvanceUntil>(std::move(condition), last_tick);
}

}  // namespace manager
