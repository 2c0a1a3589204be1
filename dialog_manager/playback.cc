#include "dialog_manager/playback.h"

#include <vector>

#include "dialog_manager/manager.h"
#include "dialog_manager/replay.h"

namespace manager {

using namespace objdb;

void Playback::tick() {
  inside_tick_ = false;
  manager_.history.forget();
  manager_.world.forget_history();
  manager_.clock.advance();
  // what was put off has been said by the journal too
  (void)manager_.schedule.take_due(manager_.clock.time(), manager_.world);
}

void Playback::end(bool live) {
  manager_.history.roll_back_open();
  replaying_ = inside_tick_ = false;
  if (live)
    for (const auto& each : manager_.programs.all()) each->catch_up();
  if (rewinding_) manager_.recorder.add_rewind(*rewinding_);
  rewinding_.reset();
}

Outcome Playback::rewind(double time) {
  Journal* journal = manager_.recorder.journal();
  if (journal == nullptr) return Error{ErrorKind::io, "rewind needs a journal, expected journal FILE before", 0};
  if (Status kept = journal->flush(true); !kept) return kept.error();
  Result<JournalText> text = read_journal(journal->path());
  if (!text) return text.error();
  const double now = manager_.clock.time();
  if (!(time >= text->start.time - 1e-9 && time <= now + 1e-9))
    return Error{ErrorKind::range,
                 "the time is " + number(time) + ", expected " + number(text->start.time) + " to " + number(now) + " s",
                 0};
  text->records = records_until(std::move(text->records), text->start, time);
  empty_world();
  rewinding_ = time;
  return replay(std::move(*text), true);
}

// an empty world, and nobody in it
void Playback::empty_world() {
  manager_.programs.kill_all();
  std::vector<ObjectId> all;
  manager_.world.for_each("**", [&](const Object& object) { all.push_back(object.id); });
  (void)manager_.world.erase(all, true);
  manager_.schedule.clear();
  manager_.set_budget({});
  manager_.history.forget();
}

}  // namespace manager
