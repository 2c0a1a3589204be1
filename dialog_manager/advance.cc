#include "dialog_manager/advance.h"

#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

// the way from one tick to another
class Way {
 public:
  explicit Way(std::uint64_t last) : last_(last) {}
  std::optional<double> share(const Manager& manager) const {
    const std::uint64_t tick = manager.clock.tick();
    if (!first_) first_ = tick;
    if (last_ <= *first_) return std::nullopt;
    return static_cast<double>(tick - *first_) / static_cast<double>(last_ - *first_);
  }

 private:
  std::uint64_t last_;
  mutable std::optional<std::uint64_t> first_;
};

// not yet; or never, when nobody else is there to say resume
std::optional<Status> not_yet(const Manager& manager, std::uint16_t source) {
  if (!manager.paused_for_good(source)) return std::nullopt;
  return Status(
      Error{ErrorKind::busy, "time is paused at " + number(manager.clock.time()) + " s; expected resume, or step", 0});
}

class AdvanceTo : public Operation {
 public:
  AdvanceTo(std::uint16_t source, std::uint64_t tick) : source_(source), tick_(tick) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    if (manager.clock.tick() < tick_) return not_yet(manager, source_);
    return Status();
  }
  bool wants_tick(const Manager& manager) const override { return manager.clock.tick() < tick_; }
  std::optional<double> share(const Manager& manager) const override { return way_.share(manager); }

 private:
  std::uint16_t source_;
  std::uint64_t tick_;
  Way way_{tick_};
};

class StepTo : public Operation {
 public:
  explicit StepTo(std::uint64_t tick) : tick_(tick) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    if (manager.clock.tick() < tick_) return std::nullopt;
    return Status();
  }
  bool wants_tick(const Manager& manager) const override { return manager.clock.tick() < tick_; }
  std::optional<double> share(const Manager& manager) const override { return way_.share(manager); }
  bool steps() const override { return true; }

 private:
  std::uint64_t tick_;
  Way way_{tick_};
};

class AdvanceUntil : public Operation {
 public:
  AdvanceUntil(std::uint16_t source, Condition condition, std::uint64_t last_tick)
      : source_(source), condition_(std::move(condition)), last_tick_(last_tick) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    const Result<bool> holds = condition_.holds(manager.world);
    if (!holds) return Status(holds.error());
    if (*holds) return Status();
    if (manager.clock.tick() < last_tick_) return not_yet(manager, source_);
    return Status(
        Error{ErrorKind::timeout, condition_.failure(manager.world) + " by " + number(manager.clock.time()) + " s", 0});
  }
  bool wants_tick(const Manager& manager) const override { return manager.clock.tick() < last_tick_; }
  std::optional<double> share(const Manager& manager) const override { return way_.share(manager); }

 private:
  std::uint16_t source_;
  Condition condition_;
  std::uint64_t last_tick_;
  Way way_{last_tick_};
};

}  // namespace

std::unique_ptr<Operation> advance_to(std::uint16_t source, std::uint64_t tick) {
  return std::make_unique<AdvanceTo>(source, tick);
}

std::unique_ptr<Operation> step_to(std::uint64_t tick) { return std::make_unique<StepTo>(tick); }

std::unique_ptr<Operation> advance_until(std::uint16_t source, Condition condition, std::uint64_t last_tick) {
  return std::make_unique<AdvanceUntil>(source, std::move(condition), last_tick);
}

}  // namespace manager
