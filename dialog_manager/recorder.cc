#include "dialog_manager/recorder.h"

#include "dialog_manager/manager.h"

namespace manager {

using namespace objdb;

Status Recorder::begin(const std::string& path, Journal::Sync sync) {
  const Clock& clock = manager_.clock;
  Result<std::unique_ptr<Journal>> made = Journal::create(
      path, sync,
      {clock.tick(), clock.time(), clock.rate(), manager_.options().seed, clock.base_tick(), clock.base_time()});
  if (!made) return made.error();
  const std::string world = save(manager_.world);
  if (Status room = (*made)->reserve(world.size() + world.size() / 16 + 4096); !room) return room.error();
  std::unique_ptr<Journal> before = std::exchange(journal_, std::move(*made));
  // the world as it stands, said by the manager; then who moves it
  add_world(world);
  for (const auto& each : manager_.programs.all())
    if (each->state() == Manipulator::State::active) add(*manager_.main_session(), "", each->command);
  add_steering();
  Status kept = journal_->flush(true);
  if (!kept) journal_ = std::move(before);
  return kept;
}

void Recorder::add_world(const std::string& text) {
  Source self;
  self.name = manager_.source_name(0);
  for_each_line(text, [&](std::string_view line) { add(self, "", line); });
}

// what the world does not say of itself: the budget, and what was put off
void Recorder::add_steering() {
  Source self;
  if (manager_.budget().of != Budget::Of::nothing) add(*manager_.main_session(), "", manager_.budget().line());
  self.name = later_source;
  for (const Schedule::Entry& entry : manager_.schedule.entries())
    add(self, entry.scope.prefix,
        std::to_string(entry.id) + " " + number(entry.start) + " " + std::to_string(entry.runs) +
            (entry.held ? " true " : " false ") + Schedule::say(entry));
  if (manager_.schedule.next_id() > 1) add(self, "", std::to_string(manager_.schedule.next_id()));
}

Status Recorder::resume(const std::string& path, const JournalText& text) {
  Result<std::unique_ptr<Journal>> journal = Journal::resume(path, Journal::Sync::everysec, text.good, text.check);
  if (!journal) return journal.error();
  journal_ = std::move(*journal);
  return {};
}

void Recorder::end() {
  if (keep(true)) journal_.reset();
}

Status Recorder::room_for(std::size_t bytes) { return journal_ ? journal_->reserve(bytes) : Status(); }

Status Recorder::room_for_tick() { return journal_ ? journal_->reserve_tick() : Status(); }

void Recorder::add(const Source& source, std::string_view prefix, std::string_view line) {
  if (journal_ == nullptr || manager_.playback.replaying()) return;
  // a line that was joined from several is kept as one
  journal_->add(manager_.clock.tick() + (manager_.tick_in_flight() ? 1 : 0), source.name, prefix, line);
}

void Recorder::add_checkpoint(std::string_view program, bool ended) {
  Source self;
  self.name = checkpoint_source;
  add(self, "", std::string(program) + (ended ? " done" : ""));
}

void Recorder::add_rewind(double time) {
  Source self;
  self.name = rewind_source;
  add(self, "", number(time));
}

void Recorder::close_tick() {
  if (journal_ == nullptr || manager_.playback.replaying()) return;
  std::string line = "tick " + number(manager_.clock.time()) + " ";
  append_hexadecimal(line, manager_.hash());
  journal_->add(manager_.clock.tick(), tick_source, "", line);
  (void)keep(true);
}

bool Recorder::keep(bool tick_ended) {
  if (!journal_) return true;
  const Status kept = journal_->flush(tick_ended);
  if (kept) return true;
  if (!lost_) manager_.errors().write("dialog_manager: error io " + kept.error().sentence + "\n");
  lost_ = true;
  manager_.lose_answers();
  return false;
}

}  // namespace manager
