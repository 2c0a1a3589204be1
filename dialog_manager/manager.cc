#include "dialog_manager/manager.h"

#include <fcntl.h>
#include <sys/stat.h>
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

namespace manager {
namespace {

using namespace objdb;
using Wall = channel::Clock;

// changes; a transaction and the latest command may be longer
constexpr std::size_t undo_limit = 1 << 16;
constexpr int lines_at_a_time = 4096;

// a forwarded command waits for its manipulator's answer
class Asked : public Operation {
 public:
  Asked(std::string program, std::uint64_t number) : program_(std::move(program)), number_(number) {}
  std::optional<Status> poll(Manager& manager, std::string& out) override {
    Manipulator* manipulator = manager.find_manipulator(program_);
    if (manipulator == nullptr) return Status(Error{ErrorKind::gone, program_ + " is gone", 0});
    std::optional<Manipulator::Reply> reply = manipulator->take_reply(number_);
    if (!reply) return std::nullopt;
    out += reply->body;
    return reply->status;
  }

 private:
  std::string program_;
  std::uint64_t number_;
};

Error unknown_verb(const Manager& manager, const Word& verb) {
  if (verb.quoted) return {ErrorKind::unknown, "no verb " + shown(verb.text) + ": a verb is a bare word", verb.column};
  std::vector<std::string_view> names;
  for (const Command* command : commands()) names.push_back(command->name);
  for (const auto& manipulator : manager.manipulators())
    for (const Manipulator::Verb& each : manipulator->verbs()) names.push_back(each.name);
  return {ErrorKind::unknown,
          "no verb " + quote(verb.text.substr(0, 60)) + did_you_mean(verb.text.substr(0, 60), names), verb.column};
}

// a program speaks about its part of the world. What a person does at its window comes over a FIFO of its own, and may
// stop time
bool is_for_programs(const Command& command) {
  static constexpr std::string_view steering[] = {"listen", "unlisten", "pause", "resume"};
  if (command.name == "type" || command.name == "field") return false;
  return command.effect != Effect::control ||
         std::find(std::begin(steering), std::end(steering), command.name) != std::end(steering);
}

}  // namespace

Manager::Manager(Options options)
    : options_(std::move(options)),
      out_(loop_, STDOUT_FILENO, channel::Descriptor::shared),
      errors_(loop_, STDERR_FILENO, channel::Descriptor::shared),
      source_names_{"manager"} {
  world.keep_history(std::numeric_limits<std::size_t>::max());
  clock.set_pace(options_.pace);
  loop_.on_signal({SIGINT, SIGTERM, SIGHUP}, [this](int signal) {
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
  open_streams();
}

Manager::~Manager() = default;

void Manager::open_streams() {
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
  if (!options_.read_input) return;
  Input input;
  input.name = "<stdin>";
  if (options_.terminal) {
    prompt_ =
        std::make_unique<Prompt>(loop_, [this](const std::string& line, std::size_t start, const std::string& word) {
          return complete(*this, line, start, word);
        });
    main_->abbreviate(true);
    input.live = std::make_unique<channel::Reader>(loop_, prompt_->reader(), channel::Descriptor::own, 65536);
  } else {
    input.live = std::make_unique<channel::Reader>(loop_, STDIN_FILENO, channel::Descriptor::shared, 65536);
  }
  main_->enqueue(std::move(input));
}

std::uint16_t Manager::add_source(std::string name) {
  // a program that is started again under its name is the same source
  const auto known = std::find(source_names_.begin(), source_names_.end(), name);
  if (known != source_names_.end()) return static_cast<std::uint16_t>(known - source_names_.begin());
  source_names_.push_back(std::move(name));
  return static_cast<std::uint16_t>(source_names_.size() - 1);
}

std::string Manager::source_name(std::uint16_t id) const { return id < source_names_.size() ? source_names_[id] : "?"; }

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
  prompt_.reset();
  end_programs();
  traces_.clear();
  for (const std::string& path : made_fifos_) ::unlink(path.c_str());
  (void)keep(true);
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
  bool did = false;
  ending_.clear();
  for (const auto& manipulator : manipulators_) {
    manipulator->check_deadline();
    did |= manipulator->step();
  }
  if (checkpointing_) return step_checkpoints() || did;
  if (tick_in_flight()) return step_tick() || did;
  did |= step_sessions();
  if ((did || !unwatched_.empty()) && !tick_in_flight() && !in_transaction()) tell_watchers();
  if (tick_in_flight() || quitting_) return did;
  if (wants_tick()) {
    const auto due = clock.next_tick_due();
    if (!due || *due <= Wall::now()) {
      if (!begin_checkpoints()) begin_tick();
      return true;
    }
  }
  return did;
}

bool Manager::step_sessions() {
  // what the schedule began is ended before anyone else speaks
  if (scheduled_->operation() != nullptr) {
    const bool did = scheduled_->step(*this, 1);
    if (scheduled_->operation() != nullptr) return did;
  }
  // a few lines each, so that nobody waits for a flood
  bool did = main_->step(*this, lines_at_a_time);
  for (const auto& speaker : speakers_) {
    if (tick_in_flight() || scheduled_->operation() != nullptr) break;
    did |= speaker->step(*this, lines_at_a_time / 16);
  }
  return did;
}

bool Manager::all_read() const {
  return main_->finished() && scheduled_->operation() == nullptr && !tick_in_flight() && !checkpointing_;
}

std::optional<Wall::time_point> Manager::next_deadline() const {
  std::optional<Wall::time_point> first;
  const auto take = [&](std::optional<Wall::time_point> each) {
    if (each && (!first || *each < *first)) first = each;
  };
  for (const auto& manipulator : manipulators_) take(manipulator->deadline());
  const auto take_session = [&](const Session& session) {
    if (session.operation() != nullptr) take(session.operation()->deadline());
  };
  take_session(*main_);
  take_session(*scheduled_);
  for (const auto& speaker : speakers_) take_session(*speaker);
  if (!tick_in_flight() && !checkpointing_ && wants_tick()) take(clock.next_tick_due());
  return first;
}

void Manager::flush() {
  // first the journal, then what acknowledges it
  if (!keep(false)) return;
  // what is told while somebody types stands above what is typed
  if (prompt_ && (out_.pending() > 0 || errors_.pending() > 0)) prompt_->hide();
  for (const auto& manipulator : manipulators_) manipulator->flush();
  out_.flush();
  errors_.flush();
  if (prompt_ && main_->idle() && out_.pending() == 0 && errors_.pending() == 0) prompt_->show();
}

void Manager::interrupt() {
  if (main_->operation() != nullptr) {
    free_ = false;
    main_->end_operation(*this, Error{ErrorKind::gone, "interrupted", 0});
  } else {
    prompt_->cancel();
  }
}

const Command* Manager::abbreviated(std::string_view verb) const {
  // the shortest that fits, when all others that fit only go on from it: lis is list, beside listen
  const Command* found = nullptr;
  for (const Command* command : commands())
    if (command->name.starts_with(verb) && (found == nullptr || command->name.size() < found->name.size()))
      found = command;
  if (found == nullptr) return nullptr;
  for (const Command* command : commands())
    if (command->name.starts_with(verb) && !command->name.starts_with(found->name)) return nullptr;
  return found;
}

// -- commands

Outcome Manager::execute(Source& source, Session* session, const LineWords& words, std::string_view line,
                         const Scope& scope, std::string& out) {
  const Words all = words.words();
  Call call{*this, source, session, scope, all[0], all.subspan(1), line, out};
  const Command* command = all[0].quoted ? nullptr : find_command(all[0].text);
  if (command == nullptr && session != nullptr && session->abbreviates() && !all[0].quoted)
    command = abbreviated(all[0].text);
  if (command == nullptr) {
    for (const auto& manipulator : manipulators_)
      for (const Manipulator::Verb& verb : manipulator->verbs())
        if (verb.name == all[0].text && !all[0].quoted) return forward(call, *manipulator, verb);
    return unknown_verb(*this, all[0]);
  }
  if (call.words.size() < command->least || call.words.size() > command->most)
    return Error{
        ErrorKind::syntax,
        "expected " + std::string(command->name) + (command->syntax.empty() ? "" : " ") + std::string(command->syntax),
        (call.words.size() < command->least || call.words.empty() ? all.back() : call.words[command->most]).column};
  if (command->effect == Effect::time && (session == nullptr || session == scheduled_.get()))
    return Error{ErrorKind::busy, std::string(command->name) + " makes time pass: only people and scripts can say it",
                 all[0].column};
  if (command->effect == Effect::time && in_transaction())
    return Error{ErrorKind::busy, std::string(command->name) + " makes time pass: commit or rollback first",
                 all[0].column};
  if (source.gate != nullptr && !is_for_programs(*command))
    return Error{ErrorKind::owner,
                 std::string(command->name) + " is not for programs: only people and scripts can say it",
                 all[0].column};
  if (options_.check && command->effect != Effect::change) return check_only(call, *command);
  const bool kept = journal_ != nullptr && !replaying_ && is_journaled(*command);
  if (kept)
    if (Status room = journal_->reserve(line.size() + source.name.size() + scope.prefix.size() + 256); !room)
      return room;
  if (command->effect != Effect::change) {
    monitor(source, line);
    Outcome outcome = command->run(call);
    // a program that could not be started is not started again by who goes on with the journal
    outcome.kept = kept && outcome.operation != nullptr;
    if (kept && outcome.status && !outcome.kept) journal(source, scope.prefix, line);
    return outcome;
  }

  speak_as(source, line);
  const std::uint64_t mark = world.mark();
  Outcome outcome = command->run(call);
  ++counters.lines;
  if (!outcome.status) {
    world.roll_back(mark);
    return outcome;
  }
  monitor(source, line);
  if (kept) journal(source, scope.prefix, call.kept.empty() ? line : call.kept);
  if (world.mark() != mark && !in_transaction() && !tick_in_flight()) {
    remember(mark);
  }
  return outcome;
}

void Manager::speak_as(const Source& source, std::string_view line) {
  world.speak_as({lines.add(line), static_cast<std::uint32_t>(clock.tick() + (in_tick() ? 1 : 0)), source.id});
}

// --check makes the objects of a script, so that what is said of them can be checked; nothing else happens
Outcome Manager::check_only(Call& call, const Command& command) {
  if (command.name == "source" || command.name == "start") return command.run(call);
  if (command.name == "expect" || command.name == "wait" || command.name == "when") {
    std::size_t used = 0;
    const Result<Condition> condition = Condition::parse(world, call.words, call.scope, used);
    if (!condition) return condition.error();
  }
  return {};
}

Outcome Manager::forward(Call& call, Manipulator& manipulator, const Manipulator::Verb& verb) {
  if (options_.check) return {};
  if (call.session == nullptr)
    return Error{ErrorKind::busy,
                 verb.name + " is a verb of " + manipulator.name + ": only people and scripts can say it",
                 call.verb.column};
  if (in_transaction())
    return Error{ErrorKind::busy, verb.name + " acts on the world: commit or rollback first", call.verb.column};
  // one of several shards serves the object that is named first
  Manipulator* addressed = &manipulator;
  if (!call.words.empty()) {
    const Result<const Object*> object = find_object(world, call.words[0], call.scope);
    if (object)
      for (const auto& each : manipulators_)
        for (const Manipulator::Verb& other : each->verbs())
          if (other.name == verb.name && each->serves_path((*object)->path)) addressed = each.get();
  }
  if (addressed->state() == Manipulator::State::failed || addressed->state() == Manipulator::State::ended)
    return Error{ErrorKind::gone, addressed->name + " is gone", call.verb.column};
  // paths of a script that is read under a place are said in full
  std::string line(verb.name);
  for (const Word& word : call.words) {
    line += ' ';
    const bool inner =
        !call.scope.prefix.empty() && !word.quoted && world.find(call.scope.resolve(word.text)) != nullptr;
    line += inner                               ? call.scope.resolve(word.text)
            : word.quoted && is_path(word.text) ? "\"" + std::string(word.text) + "\""
                                                : quote(word.text);
  }
  if (journal_)
    if (Status room = journal_->reserve(line.size() + 256); !room) return room.error();
  world.speak_as({lines.add(call.line), static_cast<std::uint32_t>(clock.tick()), call.source.id});
  return ask(*addressed, line);
}

std::unique_ptr<Operation> Manager::ask(Manipulator& manipulator, std::string_view line) {
  const std::uint64_t number = manipulator.ask(line);
  Source asked;
  asked.name = ask_source;
  journal(asked, "", manipulator.name + " " + std::to_string(number) + " " + std::string(line));
  return std::make_unique<Asked>(manipulator.name, number);
}

void Manager::session_failed(Session& session) {
  // who speaks through a FIFO may err without ending a batch
  if (&session != main_.get() && &session != scheduled_.get()) return;
  exit_status_ = 1;
  if (options_.keep_going) return;
  if (options_.interactive)
    session.leave_texts();
  else if (session.style() == Session::Style::people)
    main_->stop();
}

void Manager::stream_ended(Session& session) {
  // a conversation that ends in mid-transaction has not said commit
  if (transaction_ == &session) (void)roll_back(session);
}

Result<Input> Manager::fifo_input(const std::string& path) {
  const auto failed = [&](ErrorKind kind, const std::string& why) {
    return Error{kind, path + " cannot be listened to: " + why, 0};
  };
  // opened anew for the writers that come after the last one left: a FIFO that has seen its end says so for ever
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0)
    return failed(errno == EMFILE || errno == ENFILE ? ErrorKind::limit : ErrorKind::io, std::strerror(errno));
  // what lies there now may be another than before
  struct stat status {};
  ::fstat(descriptor, &status);
  const bool fifo = S_ISFIFO(status.st_mode);
  if (!fifo || status.st_uid != ::geteuid() || (status.st_mode & 022) != 0) {
    ::close(descriptor);
    return failed(ErrorKind::io,
                  fifo ? "it can be written by others, expected a FIFO of ours, mode 0600" : "it is no FIFO");
  }
  Input input;
  input.name = path;
  input.fifo = true;
  input.live = std::make_unique<channel::Reader>(loop_, descriptor, channel::Descriptor::own, 4096);
  return input;
}

void Manager::event(std::string_view text) { main_->event(text); }

// -- memory

void Manager::journal(const Source& source, std::string_view prefix, std::string_view line) {
  if (journal_ == nullptr || replaying_) return;
  // a line that was joined from several is kept as one
  journal_->add(clock.tick() + (tick_in_flight() ? 1 : 0), source.name, prefix, line);
}

void Manager::journal_checkpoint(std::string_view program, bool ended) {
  Source self;
  self.name = checkpoint_source;
  journal(self, "", std::string(program) + (ended ? " done" : ""));
}

void Manager::close_tick_record() {
  if (journal_ == nullptr || replaying_) return;
  std::string line = "tick " + number(clock.time()) + " ";
  static constexpr char digits[] = "0123456789abcdef";
  const std::uint64_t value = hash();
  for (int shift = 60; shift >= 0; shift -= 4) line += digits[(value >> shift) & 15];
  journal_->add(clock.tick(), tick_source, "", line);
  (void)keep(true);
}

bool Manager::keep(bool tick_ended) {
  if (!journal_) return true;
  const Status kept = journal_->flush(tick_ended);
  if (kept) return true;
  out_.discard();
  if (!journal_lost_) errors_.write("dialog_manager: error io " + kept.error().sentence + "\n");
  journal_lost_ = true;
  exit_status_ = 1;
  quitting_ = true;
  return false;
}

void Manager::acknowledge() {
  if (keep(false)) out_.flush();
}

Status Manager::begin_journal(const std::string& path, Journal::Sync sync) {
  Result<std::unique_ptr<Journal>> made =
      Journal::create(path, sync, {clock.tick(), clock.time(), clock.rate(), options_.seed});
  if (!made) return made.error();
  const std::string world_text = save(world);
  if (Status room = (*made)->reserve(world_text.size() + world_text.size() / 16 + 4096); !room) return room.error();
  std::unique_ptr<Journal> before = std::exchange(journal_, std::move(*made));
  // the world as it stands, said by the manager; then who moves it
  Source self;
  self.name = source_name(0);
  std::string_view rest = world_text;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    journal(self, "", rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  for (const auto& manipulator : manipulators_)
    if (manipulator->state() == Manipulator::State::active) journal(*main_, "", manipulator->command);
  Status kept = journal_->flush(true);
  if (!kept) journal_ = std::move(before);
  return kept;
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
    Result<std::unique_ptr<Journal>> journal =
        Journal::resume(options_.resume, Journal::Sync::everysec, text->good, text->check);
    if (!journal) return refuse(journal.error());
    journal_ = std::move(*journal);
    text->records = records_until(*text, std::numeric_limits<double>::infinity());
    main_->await(replay(std::move(*text), true), options_.resume + ":1");
  } else if (!options_.journal.empty()) {
    if (Status begun = begin_journal(options_.journal, Journal::Sync::everysec); !begun) return refuse(begun.error());
  }
  return true;
}

void Manager::replay_tick() {
  replaying_tick_ = false;
  undo_marks_.clear();
  redo_.clear();
  world.forget_history();
  clock.advance();
  // what was put off has been said by the journal too
  (void)schedule.take_due(clock.time(), world);
}

void Manager::end_replay(bool live) {
  if (transaction_ != nullptr) (void)roll_back(*transaction_);
  replaying_ = replaying_tick_ = false;
  if (live)
    for (const auto& manipulator : manipulators_) manipulator->catch_up();
  if (rewinding_ && journal_) {
    Source self;
    self.name = "rewind";
    journal(self, "", number(*rewinding_));
  }
  rewinding_.reset();
}

Outcome Manager::rewind(double time) {
  if (journal_ == nullptr) return Error{ErrorKind::io, "rewind needs a journal, expected journal FILE before", 0};
  if (Status kept = journal_->flush(true); !kept) return kept.error();
  Result<JournalText> text = read_journal(journal_->path());
  if (!text) return text.error();
  if (!(time >= text->start.time - 1e-9 && time <= clock.time() + 1e-9))
    return Error{
        ErrorKind::range,
        "the time is " + number(time) + ", expected " + number(text->start.time) + " to " + number(clock.time()) + " s",
        0};
  text->records = records_until(*text, time);
  // an empty world, and nobody in it; then all again, up to there
  while (!manipulators_.empty()) {
    manipulators_.back()->kill();
    manipulators_.pop_back();
  }
  stages_ = 0;
  std::vector<ObjectId> all;
  world.for_each("**", [&](const Object& object) { all.push_back(object.id); });
  (void)world.erase(all, true);
  schedule.clear();
  undo_marks_.clear();
  redo_.clear();
  rewinding_ = time;
  return replay(std::move(*text), true);
}

// -- speakers on FIFOs

Status Manager::listen(const std::string& path) {
  for (const auto& speaker : speakers_)
    if (speaker->name == path) return Error{ErrorKind::exists, path + " is listened to already", 0};
  const bool made = ::mkfifo(path.c_str(), 0600) == 0;
  if (!made && errno != EEXIST)
    return Error{ErrorKind::io, path + " cannot be listened to: " + std::strerror(errno), 0};
  Result<Input> input = fifo_input(path);
  if (!input) return input.error();
  if (input->live->failed()) return Error{ErrorKind::limit, path + " cannot be listened to: too many open files", 0};
  auto session = std::make_unique<Session>(path, Session::Style::people, out_, errors_);
  session->id = add_source(path);
  session->keep_going(true);
  session->limit_lines(4096);
  session->speak_beside();
  session->enqueue(std::move(*input));
  speakers_.push_back(std::move(session));
  if (made) made_fifos_.push_back(path);
  return {};
}

Status Manager::unlisten(const std::string& path) {
  const auto speaker =
      std::find_if(speakers_.begin(), speakers_.end(), [&](const auto& each) { return each->name == path; });
  if (speaker == speakers_.end()) return Error{ErrorKind::unknown, path + " is not listened to", 0};
  if (transaction_ == speaker->get()) (void)roll_back(**speaker);
  // a session cannot be taken away while it speaks; it ends when its lines do
  (*speaker)->stop();
  ending_.push_back(std::move(*speaker));
  speakers_.erase(speaker);
  if (std::erase(made_fifos_, path) > 0) ::unlink(path.c_str());
  return {};
}

std::vector<std::string> Manager::sources() const {
  std::vector<std::string> out = {main_->name};
  for (const auto& speaker : speakers_) out.push_back(speaker->name);
  for (const auto& manipulator : manipulators_) out.push_back(manipulator->name);
  return out;
}

// -- transactions

Status Manager::begin(Session& session) {
  if (transaction_ != nullptr) return Error{ErrorKind::busy, "a transaction is open already", 0};
  transaction_ = &session;
  transaction_mark_ = world.mark();
  return {};
}

Status Manager::commit(Session& session) {
  if (transaction_ != &session) return Error{ErrorKind::unknown, "no transaction is open, expected begin first", 0};
  transaction_ = nullptr;
  if (world.mark() != transaction_mark_) remember(transaction_mark_);
  return {};
}

Status Manager::roll_back(Session& session) {
  if (transaction_ != &session) return Error{ErrorKind::unknown, "no transaction is open, expected begin first", 0};
  transaction_ = nullptr;
  world.roll_back(transaction_mark_);
  return {};
}

// a command that can be taken back; the latest one whatever its size
void Manager::remember(std::uint64_t mark) {
  redo_.clear();
  undo_marks_.push_back(mark);
  if (world.mark() - world.oldest_mark() <= undo_limit) return;
  while (undo_marks_.size() > 1 && world.mark() - undo_marks_.front() > undo_limit) undo_marks_.pop_front();
  world.forget_history(undo_marks_.front());
}

Status Manager::undo(std::size_t count) {
  if (count > undo_marks_.size())
    return Error{ErrorKind::limit,
                 "cannot take back " + std::to_string(count) + " commands, there are " +
                     std::to_string(undo_marks_.size()) + " since the last tick",
                 0};
  for (std::size_t i = 0; i < count; ++i) {
    redo_.emplace_back();
    world.roll_back(undo_marks_.back(), &redo_.back());
    undo_marks_.pop_back();
  }
  return {};
}

Status Manager::redo(std::size_t count) {
  if (count > redo_.size())
    return Error{
        ErrorKind::limit,
        "cannot do " + std::to_string(count) + " commands again, " + std::to_string(redo_.size()) + " were taken back",
        0};
  for (std::size_t i = 0; i < count; ++i) {
    undo_marks_.push_back(world.mark());
    world.roll_forward(redo_.back());
    redo_.pop_back();
  }
  return {};
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
  if (in_transaction() || scheduled_->operation() != nullptr) return false;
  if (free_ && !paused()) return true;
  const auto wants = [&](const Session& session) {
    const Operation* operation = session.operation();
    return operation != nullptr && operation->wants_tick(*this) && (!paused() || operation->steps());
  };
  return wants(*main_) ||
         std::any_of(speakers_.begin(), speakers_.end(), [&](const auto& each) { return wants(*each); });
}

bool Manager::begin_checkpoints() {
  const std::uint64_t tick = clock.tick() + 1;
  for (const auto& manipulator : manipulators_) {
    if (!manipulator->wants_checkpoint(tick, clock.rate())) continue;
    manipulator->ask_checkpoint();
    checkpointing_ = true;
  }
  return checkpointing_;
}

bool Manager::step_checkpoints() {
  if (std::any_of(manipulators_.begin(), manipulators_.end(), [](const auto& each) { return each->answering(); }))
    return false;
  for (Manipulator* manipulator : by_name()) manipulator->apply_checkpoint();
  checkpointing_ = false;
  begin_tick();
  return true;
}

std::vector<Manipulator*> Manager::by_name() const {
  std::vector<Manipulator*> out;
  for (const auto& manipulator : manipulators_) out.push_back(manipulator.get());
  std::sort(out.begin(), out.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  return out;
}

void Manager::begin_tick() {
  if (journal_)
    if (const Status room = journal_->reserve_tick(); !room) {
      if (free_) event("event journal " + room.error().sentence.substr(8) + ", time stands still");
      break_tick(room.error());
      return;
    }
  // what was done before cannot be taken back, nor done again, in another time
  undo_marks_.clear();
  redo_.clear();
  if (!following_) world.forget_history();
  stage_ = 0;
  next_stage();
}

void Manager::next_stage() {
  const std::uint64_t tick = clock.tick() + 1;
  while (stage_ < stages_) {
    bool waits = false;
    for (const auto& manipulator : manipulators_) {
      if (manipulator->stage != stage_ || !manipulator->due(tick, clock.rate())) continue;
      manipulator->send_tick(tick, clock.time_of(tick), clock.step());
      waits = true;
    }
    if (waits) return;
    ++stage_;
  }
  finish_tick();
}

bool Manager::step_tick() {
  for (const auto& manipulator : manipulators_)
    if (manipulator->stage == stage_ && manipulator->answering()) return false;
  // answers count in the order of names, whenever they came
  for (Manipulator* manipulator : by_name())
    if (manipulator->stage == stage_) manipulator->apply_answer();
  ++stage_;
  next_stage();
  return true;
}

void Manager::finish_tick() {
  stage_ = -1;
  clock.advance();
  close_tick_record();
  ++counters.ticks;
  std::erase_if(traces_, [&](const auto& trace) {
    const Status written = trace->tick(world, clock.time());
    if (!written) event("event trace " + trace->path() + " ended: " + written.error().sentence);
    return !written;
  });
  tell_watchers();
  for (const Schedule::Entry& entry : schedule.take_due(clock.time(), world))
    if (!following_) scheduled_->enqueue_command(entry.command, entry.where, entry.scope);
  scheduled_->step(*this, lines_at_a_time);
}

void Manager::break_tick(const Error& error) {
  free_ = false;
  if (checkpointing_) {
    for (const auto& manipulator : manipulators_) manipulator->abandon_tick();
    checkpointing_ = false;
  }
  if (stage_ >= 0) {
    // the tick did not happen for those who had not answered; what is known stays
    for (const auto& manipulator : manipulators_) manipulator->abandon_tick();
    stage_ = -1;
    clock.advance();
    close_tick_record();
  }
  const auto end = [&](Session& session) {
    if (session.operation() != nullptr && session.operation()->wants_tick(*this)) session.end_operation(*this, error);
  };
  end(*main_);
  for (const auto& speaker : speakers_) end(*speaker);
}

// -- programs

// -- fidelity

std::string Manager::Budget::line() const {
  if (of == Of::nothing) return "budget off";
  return std::string("budget ") + (of == Of::error ? "error " : "time ") + number(value);
}

void Manager::set_budget(const Budget& budget) {
  budget_ = budget;
  for (const auto& manipulator : manipulators_) manipulator->tell_budget();
}

// -- who looks on

void Manager::monitor(const Source& source, std::string_view line) {
  if (monitored_ == nullptr) return;
  monitored_->event("event said " + source.name + " " + std::string(line));
}

Status Manager::watch(Session& session, std::string pattern, objdb::Scope scope) {
  if (!watch_feed_) watch_feed_ = world.subscribe();
  watches_.push_back({&session, std::move(pattern), std::move(scope)});
  return {};
}

void Manager::unwatch(const Session& session) {
  std::erase_if(watches_, [&](const Watch& watch) { return watch.session == &session; });
  if (watches_.empty() && watch_feed_) {
    world.unsubscribe(*watch_feed_);
    watch_feed_.reset();
    unwatched_.clear();
  }
}

void Manager::tell_watchers() {
  if (!watch_feed_) return;
  if (!unwatched_.empty() && !main_->behind()) {
    const auto held = std::exchange(unwatched_, {});
    for (const auto& [id, field] : held)
      if (const Object* object = world.object(id)) tell_watched(*object, field);
  }
  if (!world.has_events(*watch_feed_)) return;
  world.read_feed(*watch_feed_,
                  [&](const Database::Event& event, const Object& object) { tell_watched(object, event.field); });
}

void Manager::tell_watched(const Object& object, int field) {
  for (const Watch& watch : watches_) {
    const Result<Target> target = parse_target({watch.pattern, 0, false});
    if (!target || !matches(watch.scope.resolve(target->pattern), object.path)) continue;
    if (field == Database::Event::deleted) {
      watch.session->event("event deleted " + object.path);
    } else if (field == Database::Event::created) {
      watch.session->event("event created " + object.type->name() + " " + object.path);
    } else {
      const Field& declared = object.type->field(field);
      if (!target->field.empty() && !matches(target->field, declared.name)) continue;
      if (watch.session->behind()) {
        unwatched_.emplace(object.id, field);
        continue;
      }
      std::string line = "event " + object.path + "." + declared.name + " ";
      append_value(line, declared, world.value(object, field), world);
      watch.session->event(line);
    }
  }
}

Result<Manipulator*> Manager::start(const std::string& program, const std::string& as,
                                    const std::vector<std::string>& launcher, const std::string& serving,
                                    const std::vector<std::string>& arguments) {
  std::string name = as;
  if (name.empty()) {
    name = std::filesystem::path(program).stem().string();
    for (char& c : name)
      if (!is_name(std::string(1, c)) && !(c >= '0' && c <= '9')) c = '_';
    if (!is_name(name)) name = "program_" + name;
  }
  if (!is_name(name)) return Error{ErrorKind::syntax, quote(name) + " is not a name ([A-Za-z_][A-Za-z0-9_]*)", 0};
  if (Manipulator* known = find_manipulator(name)) {
    if (known->state() != Manipulator::State::failed && known->state() != Manipulator::State::ended)
      return Error{ErrorKind::exists, name + " runs already, expected another name: start " + program + " as NAME", 0};
    drop(*known);
  }
  std::vector<std::string> argv = launcher;
  std::string path = program;
  // beside the manager, then as a path, then on PATH; a launcher finds the program itself
  if (launcher.empty()) {
    const std::filesystem::path beside = std::filesystem::path(options_.program_folder) / program;
    std::error_code ignored;
    if (program.find('/') == std::string::npos && std::filesystem::exists(beside, ignored))
      path = beside.string();
    else if (program.find('/') == std::string::npos && std::filesystem::is_regular_file(program, ignored))
      path = "./" + program;
  }
  argv.push_back(path);
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  auto manipulator = std::make_unique<Manipulator>(*this, name, program, std::move(argv), serving);
  manipulator->id = add_source(name);
  if (Status launched = manipulator->launch(); !launched) return launched.error();
  manipulators_.push_back(std::move(manipulator));
  return manipulators_.back().get();
}

Manipulator* Manager::find_manipulator(std::string_view name) const {
  for (const auto& manipulator : manipulators_)
    if (manipulator->name == name) return manipulator.get();
  return nullptr;
}

void Manager::drop(Manipulator& manipulator) {
  // its fields are free for another writer
  const std::uint16_t id = manipulator.id;
  world.for_each("**", [&](const Object& object) {
    for (std::size_t i = 0; i < object.slots.size(); ++i)
      if (object.slots[i].owner == id) world.set_owner(object, static_cast<int>(i), 0);
  });
  std::erase_if(manipulators_, [&](const auto& each) { return each.get() == &manipulator; });
  (void)arrange_stages();
}

void Manager::schema_changed() {
  for (const auto& manipulator : manipulators_) manipulator->schema_changed();
}

Status Manager::arrange_stages() {
  // the fields that a derived field is computed from
  static constexpr std::string_view moving[] = {"parent", "position", "orientation", "dh", "angle"};
  std::vector<Manipulator*> members;
  for (const auto& manipulator : manipulators_)
    if (manipulator->state() != Manipulator::State::failed) members.push_back(manipulator.get());
  const std::size_t count = members.size();
  std::vector<std::vector<bool>> before(count, std::vector<bool>(count));
  for (const auto& type : world.schema().types())
    for (const Field* field : type->fields()) {
      if (field->owner != type.get()) continue;
      for (std::size_t w = 0; w < count; ++w) {
        if (!members[w]->declared().writes(world.schema(), *field)) continue;
        for (std::size_t r = 0; r < count; ++r) {
          // shards of one program stand side by side and see what the others did a tick later
          if (r == w || members[r]->program() == members[w]->program()) continue;
          bool delayed = false;
          bool reads = members[r]->declared().reads(world.schema(), *field, &delayed) && !delayed;
          if (!reads && std::find(std::begin(moving), std::end(moving), field->name) != std::end(moving) &&
              (type->name() == "node" || type->name() == "joint"))
            for (const int derived : {scene::Scene::world_position, scene::Scene::world_orientation}) {
              bool late = false;
              if (members[r]->declared().reads_by_name(world.scene().node_type().field(derived), &late) && !late)
                reads = true;
            }
          if (reads) before[w][r] = true;
        }
      }
    }
  // the stage of a program is the longest way that leads to it
  std::vector<int> stage(count, 0);
  for (std::size_t round = 0; round <= count; ++round) {
    bool moved = false;
    for (std::size_t w = 0; w < count; ++w)
      for (std::size_t r = 0; r < count; ++r)
        if (before[w][r] && stage[r] <= stage[w]) {
          stage[r] = stage[w] + 1;
          moved = true;
        }
    if (!moved) break;
    if (round == count) {
      std::string circle;
      for (std::size_t w = 0; w < count; ++w)
        for (std::size_t r = w + 1; r < count; ++r)
          if (before[w][r] && before[r][w]) circle = members[w]->name + " and " + members[r]->name;
      return Error{ErrorKind::busy,
                   (circle.empty() ? "some programs" : circle) +
                       " each read what the other writes, expected one of the reads to be declared delayed",
                   0};
    }
  }
  stages_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    members[i]->stage = stage[i];
    stages_ = std::max(stages_, stage[i] + 1);
  }
  return {};
}

void Manager::end_programs() {
  for (auto each = manipulators_.rbegin(); each != manipulators_.rend(); ++each) (*each)->quit();
  // quit, 2 s, SIGTERM, 2 s, SIGKILL
  const auto start = Wall::now();
  bool terminated = false;
  while (true) {
    bool alive = false;
    for (const auto& manipulator : manipulators_) {
      manipulator->step();
      manipulator->flush();
      alive |= manipulator->alive();
    }
    const auto waited = Wall::now() - start;
    if (!alive || waited > std::chrono::seconds(4)) break;
    if (waited > std::chrono::seconds(2) && !terminated) {
      terminated = true;
      for (const auto& manipulator : manipulators_)
        if (manipulator->alive()) ::kill(-manipulator->pid(), SIGTERM);
    }
    loop_.wait(Wall::now() + std::chrono::milliseconds(50));
  }
  while (!manipulators_.empty()) manipulators_.pop_back();
}

}  // namespace manager
