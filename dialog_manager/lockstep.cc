#include "dialog_manager/lockstep.h"

#include <algorithm>

#include "dialog_manager/manager.h"

namespace manager {

void Lockstep::begin() {
  if (!manager_.may_tick()) return;
  tick_follows_ = true;
  if (!begin_checkpoints()) begin_stages();
}

void Lockstep::write_down(const Manipulator* only) {
  tick_follows_ = false;
  for (const auto& each : manager_.programs.all()) {
    if ((only != nullptr && only != each.get()) || !each->can_checkpoint()) continue;
    each->ask_checkpoint();
    writing_down_ = true;
  }
}

bool Lockstep::step() { return writing_down_ ? end_checkpoints() : end_stage(); }

bool Lockstep::begin_checkpoints() {
  const std::uint64_t tick = manager_.clock.tick() + 1;
  for (const auto& each : manager_.programs.all()) {
    if (!each->wants_checkpoint(tick, manager_.clock.rate())) continue;
    each->ask_checkpoint();
    writing_down_ = true;
  }
  return writing_down_;
}

bool Lockstep::end_checkpoints() {
  const auto& programs = manager_.programs.all();
  if (std::any_of(programs.begin(), programs.end(), [](const auto& each) { return each->answering(); })) return false;
  for (Manipulator* each : manager_.programs.by_name()) each->apply_checkpoint();
  writing_down_ = false;
  // who failed meanwhile may hold time
  if (tick_follows_ && manager_.may_tick()) begin_stages();
  return true;
}

void Lockstep::begin_stages() {
  if (!manager_.begin_tick()) return;
  stage_ = 0;
  begin_stage();
}

void Lockstep::begin_stage() {
  const Clock& clock = manager_.clock;
  const std::uint64_t tick = clock.tick() + 1;
  for (; stage_ < manager_.programs.stages(); ++stage_) {
    bool waits = false;
    for (const auto& each : manager_.programs.all()) {
      if (each->stage != stage_ || !each->due(tick, clock.rate())) continue;
      each->send_tick(tick, clock.time_of(tick), clock.step());
      waits = true;
    }
    if (waits) return;
  }
  stage_ = -1;
  manager_.finish_tick();
}

bool Lockstep::end_stage() {
  for (const auto& each : manager_.programs.all())
    if (each->stage == stage_ && each->answering()) return false;
  // answers count in the order of names, whenever they came
  for (Manipulator* each : manager_.programs.by_name())
    if (each->stage == stage_) each->apply_answer();
  ++stage_;
  begin_stage();
  return true;
}

}  // namespace manager
