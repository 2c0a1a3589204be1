#include "dialog_manager/manager.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

#include "dialog_manager/completion.h"
#include "dialog_manager/replay.h"
#include "dialog_manager/screen_text.h"

namespace manager {
namespace {

using namespace objdb;
using Wall = channel::Clock;

constexpr int lines_at_a_time = 4096;

}  // namespace

Manager::Manager(Options options)
    : out_(loop_, STDOUT_FILENO, channel::Descriptor::shared),
      errors_(loop_, STDERR_FILENO, channel::Descriptor::shared),
      options_(std::move(options)),
      source_names_{"manager"} {
  world.keep_history(std::numeric_limits<std::size_t>::max());
  clock.set_pace(options_.pace);
  loop_.on_signal({SIGINT, SIGTERM, SIGHUP, SIGWINCH, SIGCONT}, [this](int signal) {
    if (signal == SIGWINCH || signal == SIGCONT) {
      if (prompt_) prompt_->redraw();
      return;
    }
    if (signal == SIGINT && prompt_) {
      interrupt();
      return;
    }
    signal_ = signal;
    quitting_ = true;
  });
  const auto style = options_.framed ? Session::Style::framed : Session::Style::people;
  main_ = std::make_unique<Session>("main", style, out_, errors_);
  main_->id = add_source("main");
  main_->keep_going(options_.keep_going);
  scheduled_ = std::make_unique<Session>("schedule", style, out_, errors_);
  scheduled_->id = add_source("schedule");
  open_texts();
  if (options_.read_input) open_input();
}

Manager::~Manager() = default;

void Manager::open_texts() {
  for (Options::Text& each : options_.texts) {
    Input input;
    input.name = each.name;
    input.text = std::move(each.text);
    if (each.file) {
      input.folder = std::filesystem::path(each.name).parent_path().string();
      if (input.folder.empty()) input.folder = ".";
    }
    main_->enqueue(std::move(input));
  }
}

void Manager::open_input() {
  Input input;
  input.name = "<stdin>";
  if (options_.terminal) {
    prompt_ = std::make_unique<Prompt>(loop_, [this](const std::string& line) { return complete(*this, line); });
    if (options_.texts.empty())
      out_.write("The dialog manager of The Virtual Sailor. help lists the verbs, Tab completes, quit ends.\n");
    main_->abbreviate(true);
    input.live = std::make_unique<channel::Reader>(loop_, prompt_->reader(), channel::Descriptor::own, 65536);
  } else {
    input.live = std::make_unique<channel::Reader>(loop_, STDIN_FILENO, channel::Descriptor::shared, 65536);
  }
  main_->enqueue(std::move(input));
}

bool Manager::open_journals() {
  const auto refuse = [&](const Error& error) {
    errors_.write("dialog_manager: error " + std::string(name_of(error.kind)) + " " + error.sentence + "\n");
    errors_.drain(std::chrono::seconds(1));
    return false;
  };
  if (!options_.resume.empty()) {
    Result<JournalText> text = read_journal(options_.resume);
    if (!text) return refuse(text.error());
    options_.seed = text->start.seed;
    if (!text->flaw.empty())
      event("event journal " + options_.resume + " " + text->flaw + "; what stands before it is taken up");
    // nobody else may write it from now on
    if (Status resumed = recorder.resume(options_.resume, *text); !resumed) return refuse(resumed.error());
    text->records = records_until(std::move(text->records), text->start, std::numeric_limits<double>::infinity());
    main_->await(replay(std::move(*text), true), options_.resume + ":1");
  } else if (!options_.journal.empty()) {
    if (Status begun = recorder.begin(options_.journal, Journal::Sync::everysec); !begun) return refuse(begun.error());
  }
  return true;
}

// -- the loop

int Manager::run() {
  if (!open_journals()) return 1;
  bool busy = false;
  while (!quitting_) {
    const bool did = step();
    if (all_read()) break;
    flush();
    // who has more to say than one turn takes lets others be heard; an answer is often followed by a rest at once
    if (!did) loop_.wait(next_deadline());
    // what was typed comes through a pipe, before the prompt is shown again
    if (did ? busy : prompt_ && !prompt_->visible()) loop_.poll();
    busy = did;
  }
  return end();
}

int Manager::end() {
  prompt_.reset();
  programs.end_all();
  traces_.clear();
  speakers.remove_fifos();
  (void)recorder.keep(true);
  out_.drain(std::chrono::seconds(5));
  if (out_.failure() != 0) {
    exit_status_ = 1;
    if (out_.failure() != EPIPE)
      errors_.write(std::string("dialog_manager: error io standard output cannot be written: ") +
                    std::strerror(out_.failure()) + "\n");
  }
  errors_.drain(std::chrono::seconds(1));
  return signal_ != 0 ? 128 + signal_ : exit_status_;
}

bool Manager::step() {
  speakers.bury();
  bool did = programs.step();
  if (!lockstep_.resting()) return lockstep_.step() || did;
  did |= step_sessions();
  if ((did || watches.held()) && resting() && !history.in_transaction()) watches.tell(main_->behind());
  if (!resting() || quitting_) return did;
  return step_time() || did;
}

bool Manager::step_time() {
  if (!wants_tick()) return false;
  const auto due = clock.next_tick_due();
  if (due && *due > Wall::now()) return false;
  lockstep_.begin();
  return true;
}

bool Manager::step_sessions() {
  // what the schedule began is ended before anyone else speaks
  if (!scheduled_->finished()) {
    const bool did = scheduled_->step(*this, lines_at_a_time);
    if (!scheduled_->finished()) return did;
  }
  // a few lines each, so that nobody waits for a flood
  bool did = main_->step(*this, lines_at_a_time);
  // what they say may add speakers, or take some away, which are buried in the next turn
  std::vector<Session*> now;
  for (const auto& speaker : speakers.all()) now.push_back(speaker.get());
  for (Session* speaker : now) {
    if (!resting() || !scheduled_->finished()) break;
    did |= speaker->step(*this, lines_at_a_time / 16);
  }
  return did;
}

bool Manager::all_read() const { return main_->finished() && scheduled_->finished() && lockstep_.resting(); }

std::optional<Wall::time_point> Manager::next_deadline() const {
  std::optional<Wall::time_point> first = programs.deadline();
  const auto take = [&](std::optional<Wall::time_point> each) {
    if (each && (!first || *each < *first)) first = each;
  };
  const auto take_session = [&](const Session& session) {
    if (session.operation() != nullptr) take(session.operation()->deadline());
  };
  take_session(*main_);
  take_session(*scheduled_);
  for (const auto& speaker : speakers.all()) take_session(*speaker);
  if (lockstep_.resting() && wants_tick()) take(clock.next_tick_due());
  take(progress_.next());
  return first;
}

void Manager::flush() {
  // first the journal, then what acknowledges it
  if (!recorder.keep(false)) return;
  show_progress();
  // what is told while somebody types stands above what is typed
  if (out_.pending() > 0 || errors_.pending() > 0) {
    progress_.clear();
    if (prompt_) prompt_->hide();
  }
  programs.flush();
  out_.flush();
  errors_.flush();
  if (prompt_ && main_->idle() && out_.pending() == 0 && errors_.pending() == 0) prompt_->show(main_->within_line());
}

void Manager::show_progress() {
  const Operation* work = main_->operation();
  if (work == nullptr || options_.framed) {
    progress_.rest();
    return;
  }
  const auto waited_for = [this] {
    std::string out;
    for (const auto& each : programs.all())
      if (each->waiting() > 1 || each->state() == Manipulator::State::starting)
        out += (out.empty() ? "waiting for " : ", ") + each->name;
    return out;
  };
  progress_.work([&] { return work->share(*this); }, waited_for);
}

std::size_t Manager::columns() const { return prompt_ ? terminal_columns(STDOUT_FILENO) : 0; }

std::string Manager::caret(int column) const {
  const std::optional<std::size_t> place = prompt_ ? prompt_->place(column) : std::nullopt;
  return place ? std::string(*place, ' ') + "^\n" : std::string();
}

void Manager::acknowledge() {
  if (recorder.keep(false)) out_.flush();
}

void Manager::lose_answers() {
  out_.discard();
  exit_status_ = 1;
  quitting_ = true;
}

void Manager::interrupt() {
  if (main_->operation() != nullptr) {
    free_ = false;
    main_->end_operation(*this, Error{ErrorKind::gone, "interrupted", 0});
  } else {
    main_->drop_line();
    prompt_->cancel();
  }
}

// -- who speaks

std::uint16_t Manager::add_source(std::string name) {
  // a program that is started again under its name is the same source
  const auto known = std::find(source_names_.begin(), source_names_.end(), name);
  if (known != source_names_.end()) return static_cast<std::uint16_t>(known - source_names_.begin());
  source_names_.push_back(std::move(name));
  return static_cast<std::uint16_t>(source_names_.size() - 1);
}

std::string Manager::source_name(std::uint16_t id) const { return id < source_names_.size() ? source_names_[id] : "?"; }

std::vector<std::string> Manager::sources() const {
  std::vector<std::string> out = {main_->name};
  for (const auto& speaker : speakers.all()) out.push_back(speaker->name);
  for (const auto& program : programs.all()) out.push_back(program->name);
  return out;
}

void Manager::session_failed(Session& session) {
  // who speaks through a FIFO may err without ending a batch
  if (&session != main_.get() && &session != scheduled_.get()) return;
  exit_status_ = 1;
  if (options_.keep_going) return;
  // a program that speaks goes on after an error; what it was given to read first does not
  if (options_.interactive || (session.style() == Session::Style::framed && options_.read_input))
    session.leave_texts();
  else
    main_->stop();
}

void Manager::stream_ended(Session& session) {
  // a conversation that ends in mid-transaction has not said commit
  if (history.in_transaction_of(session)) history.roll_back_open();
}

void Manager::set_budget(const Budget& budget) {
  budget_ = budget;
  for (const auto& program : programs.all()) program->tell_budget();
}

// -- time

void Manager::pause(const Source& source) { paused_by_ = source.id; }

void Manager::go_on() {
  if (paused()) clock.wake();
  paused_by_.reset();
}

bool Manager::paused_for_good(std::uint16_t source) const {
  return paused_by_ == source || paused_by_ == scheduled_->id;
}

bool Manager::wants_tick() const {
  if (history.in_transaction() || !scheduled_->finished()) return false;
  if (free_ && !paused()) return true;
  const auto wants = [&](const Session& session) {
    const Operation* operation = session.operation();
    return operation != nullptr && operation->wants_tick(*this) && (!paused() || operation->steps());
  };
  return wants(*main_) ||
         std::any_of(speakers.all().begin(), speakers.all().end(), [&](const auto& each) { return wants(*each); });
}

bool Manager::may_tick() {
  for (const auto& program : programs.all()) {
    if (!program->holds_time()) continue;
    Error error = program->failure();
    error.sentence += "; expected end " + program->name + ", or to start it again";
    end_waiting(error);
    return false;
  }
  return true;
}

bool Manager::begin_tick() {
  if (const Status room = recorder.room_for_tick(); !room) {
    end_waiting(room.error());
    return false;
  }
  // what was done before cannot be taken back, nor done again, in another time
  history.forget();
  if (!playback.following()) world.forget_history();
  return true;
}

void Manager::finish_tick() {
  // also who waits for no more than this tick has not got what he waited for
  if (const std::optional<Error> broken = std::exchange(broken_, std::nullopt)) end_waiting(*broken);
  clock.advance();
  recorder.close_tick();
  ++counters.ticks;
  std::erase_if(traces_, [&](const auto& trace) {
    const Status written = trace->tick(world, clock.time());
    if (!written) event("event trace " + trace->path() + " ended: " + written.error().sentence);
    return !written;
  });
  watches.tell(main_->behind());
  for (const Schedule::Entry& entry : schedule.take_due(clock.time(), world))
    if (!playback.following()) scheduled_->enqueue_command(entry.command, entry.where, entry.scope);
  scheduled_->step(*this, lines_at_a_time);
}

void Manager::break_time(const Error& error) {
  if (!tick_in_flight())
    end_waiting(error);
  else if (!broken_)
    broken_ = error;
}

void Manager::end_waiting(const Error& error) {
  if (std::exchange(free_, false)) event("event time stands still: " + error.sentence);
  const auto end = [&](Session& session) {
    if (session.operation() != nullptr && session.operation()->wants_tick(*this)) session.end_operation(*this, error);
  };
  end(*main_);
  for (const auto& speaker : speakers.all()) end(*speaker);
}

void Manager::write_down(const Manipulator* only) {
  if (resting() && !history.in_transaction() && !playback.replaying()) lockstep_.write_down(only);
}

}  // namespace manager
