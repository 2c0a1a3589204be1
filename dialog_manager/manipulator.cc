#include "dialog_manager/manipulator.h"

#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <csignal>
#include <utility>

#include "dialog_manager/manager.h"
#include "dialog_manager/put_words.h"

namespace manager {
namespace {

using namespace objdb;
using Wall = channel::Clock;

constexpr std::size_t longest_line = 65536;
constexpr auto handshake_limit = std::chrono::seconds(10);
constexpr int strikes_allowed = 3;
constexpr int starts_allowed = 5;
constexpr auto starts_window = std::chrono::seconds(10);
constexpr int refusals_in_a_row = 100;
constexpr std::size_t unread_errors = 1u << 20;
constexpr std::size_t longest_answer = 64u << 20;
// a program that dies this often of writing down its state is asked for it no longer
constexpr int checkpoints_lost_allowed = 2;

Error error_at(const Word& word, ErrorKind kind, std::string sentence) {
  return {kind, std::move(sentence), word.column};
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// "error KIND [COLUMN] sentence" as a program says it
Error parse_error(std::string_view text) {
  text.remove_prefix(std::min<std::size_t>(6, text.size()));
  Error error{ErrorKind::io, std::string(text), 0};
  for (int kind = 0; kind <= static_cast<int>(ErrorKind::io); ++kind) {
    const std::string_view word = name_of(static_cast<ErrorKind>(kind));
    if (!text.starts_with(word) || text.size() <= word.size() || text[word.size()] != ' ') continue;
    error.kind = static_cast<ErrorKind>(kind);
    error.sentence = text.substr(word.size() + 1);
    // an optional column of the forwarded line
    const std::size_t digits = error.sentence.find_first_not_of("0123456789");
    if (digits != 0 && digits != std::string::npos && error.sentence[digits] == ' ') {
      error.column = static_cast<int>(parse_count(std::string_view(error.sentence).substr(0, digits)).value_or(0));
      error.sentence.erase(0, digits + 1);
    }
    break;
  }
  return error;
}

template <class Visit>
void for_each_line(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    visit(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
}

}  // namespace

Manipulator::Manipulator(Manager& manager, std::string program_name, std::string program, std::vector<std::string> argv,
                         std::string serving)
    : manager_(manager),
      program_(std::move(program)),
      argv_(std::move(argv)),
      briefing_(manager.world, manager.arrays, declared_, std::move(serving)) {
  name = std::move(program_name);
  gate = this;
}

Manipulator::~Manipulator() {
  if (alive()) kill();
  close_process();
}

std::string_view Manipulator::state_name() const {
  static constexpr std::string_view names[] = {"starting",   "handshaking", "ready", "active",
                                               "restarting", "ended",       "failed"};
  return names[static_cast<std::size_t>(state_)];
}

// -- life

Status Manipulator::launch() {
  const Result<channel::Process> started = channel::spawn(argv_);
  if (!started) return started.error();
  process_ = *started;
  output_ = std::make_unique<channel::Reader>(manager_.loop(), process_.output, channel::Descriptor::own, longest_line);
  errors_ = std::make_unique<channel::Reader>(manager_.loop(), process_.errors, channel::Descriptor::own, longest_line);
  input_ = std::make_unique<channel::Writer>(manager_.loop(), process_.input, channel::Descriptor::own);
  exited_ = false;
  exit_ = std::make_unique<channel::ExitWatch>(manager_.loop(), process_.pidfd, [this] { exited_ = true; });
  state_ = State::handshaking;
  starts_.push_back(Wall::now());
  deadline_ = Wall::now() + handshake_limit;
  declaring_ = {};
  granted_.clear();
  long_sets_.clear();
  briefing_.begin_life();
  hello();
  return {};
}

void Manipulator::hello() {
  // another life of the program hears what the first one heard
  if (hello_.empty()) {
    hello_ = "hello protocol=1 name=" + name + " seed=" + std::to_string(manager_.options().seed) +
             " tick=" + number(manager_.clock.step()) +
             (manager_.probe().empty() ? " arrays=text" : " arrays=shm probe=" + manager_.probe()) + " schema=";
    static constexpr char digits[] = "0123456789abcdef";
    const std::uint64_t schema = manager_.world.schema().hash();
    for (int shift = 60; shift >= 0; shift -= 4) hello_ += digits[(schema >> shift) & 15];
    hello_ += '\n';
  }
  input_->write(hello_);
  input_->flush();
}

void Manipulator::quit() {
  quitting_ = true;
  if (!alive()) {
    state_ = State::ended;
    return;
  }
  input_->write("quit\n");
  flush();
}

void Manipulator::kill() {
  if (!alive()) return;
  ::kill(-process_.pid, SIGKILL);
  ::waitpid(process_.pid, nullptr, 0);
  process_.pid = -1;
}

void Manipulator::close_process() {
  pass_errors_on();
  exit_.reset();
  output_.reset();
  errors_.reset();
  input_.reset();
  process_ = {};
}

void Manipulator::end_by_force(const std::string& how) {
  kill();
  died(how);
}

void Manipulator::died(const std::string& how) {
  close_process();
  deadline_.reset();
  if (quitting_) {
    state_ = State::ended;
    return;
  }
  manager_.event("event gone " + name + " " + how);
  if (!briefing_.begun()) {
    give_up({ErrorKind::gone, name + " ended with " + how + " before it was ready", 0});
    return;
  }
  ++strikes_;
  if (writing_down_ && ++lost_checkpoints_ >= checkpoints_lost_allowed) {
    writing_down_ = false;
    manager_.event("event checkpoint " + name + " is asked for no longer: it ended with " + how + " when it was asked");
  }
  while (!starts_.empty() && Wall::now() - starts_.front() > starts_window) starts_.pop_front();
  const bool forgotten = log_.lost() && declared_.policy() == Policy::stop;
  if (strikes_ >= strikes_allowed || static_cast<int>(starts_.size()) > starts_allowed || forgotten) {
    give_up({how == "timeout" ? ErrorKind::timeout : ErrorKind::gone,
             name + " ended with " + how + " at tick " + std::to_string(last_tick_) +
                 (forgotten ? ", and what it was told without a checkpoint is more than is kept"
                            : ", " + std::to_string(strikes_) + (strikes_ == 1 ? " time" : " times in a row")),
             0});
    return;
  }
  static constexpr int pauses_ms[] = {0, 50, 100, 200, 400};
  const std::size_t step = std::min<std::size_t>(static_cast<std::size_t>(strikes_ - 1), 4);
  state_ = State::restarting;
  restart_at_ = Wall::now() + std::chrono::milliseconds(pauses_ms[step]);
}

void Manipulator::restart() {
  restart_at_.reset();
  ++restarts_;
  if (Status launched = launch(); !launched) give_up(launched.error());
}

void Manipulator::give_up(Error error) {
  if (alive()) kill();
  close_process();
  state_ = State::failed;
  failure_ = std::move(error);
  deadline_.reset();
  restart_at_.reset();
  abandon_tick();
  for (auto& [number, reply] : requests_)
    if (!reply) reply = Reply{{}, failure_};
  manager_.event("event failed " + name);
  if (!briefing_.begun()) return;
  // changes are not kept for who will not hear of them
  briefing_.end();
  if (declared_.policy() == Policy::stop) manager_.break_tick(failure_);
}

bool Manipulator::step() {
  bool did = false;
  if (restart_at_ && Wall::now() >= *restart_at_) {
    restart();
    did = true;
  }
  if (!alive()) return did;
  pass_errors_on();

  std::string_view line;
  bool ended = false;
  while (alive() && !ended) {
    using Next = channel::LineBuffer::Next;
    switch (output_->lines().next(line)) {
      case Next::line:
        did = true;
        receive(line);
        break;
      case Next::too_long:
        did = true;
        refuse(
            {ErrorKind::limit, "a line is longer than " + std::to_string(longest_line) + " bytes and was skipped", 1});
        break;
      case Next::half: break;  // never carried out
      case Next::end: ended = true; break;
      case Next::none:
        output_->want();
        if (!output_->lines().has_line() && !output_->at_end()) {
          if (!exited_) return did;
          ended = true;
        }
        break;
    }
  }
  if (!ended) return true;
  // the end of its words is its end: what is left of it and of its children goes with it
  const std::string how = how_it_ended();
  ::kill(-process_.pid, SIGKILL);
  process_.pid = -1;
  died(how);
  return true;
}

std::string Manipulator::how_it_ended() {
  std::string how = channel::reap(process_.pid);
  // a moment to end by itself, so that its exit status can be told
  for (int i = 0; i < 20 && how.empty() && !exited_; ++i) {
    ::usleep(1000);
    how = channel::reap(process_.pid);
  }
  if (!how.empty()) return how;
  ::kill(-process_.pid, SIGKILL);
  ::waitpid(process_.pid, nullptr, 0);
  return "closed output";
}

std::optional<Wall::time_point> Manipulator::deadline() const { return restart_at_ ? restart_at_ : deadline_; }

void Manipulator::check_deadline() {
  if (!deadline_ || Wall::now() < *deadline_ || !alive()) return;
  if (!briefing_.begun()) {
    give_up({ErrorKind::timeout, name + " did not say ready in 10 s", 0});
    return;
  }
  end_by_force("timeout");
}

bool Manipulator::owes() const { return answering() || asked() > 0; }

void Manipulator::set_deadline() {
  if (state_ != State::active) return;
  if (owes())
    deadline_ = Wall::now() + declared_.timeout();
  else
    deadline_.reset();
}

double Manipulator::waiting() const {
  return owes() ? std::chrono::duration<double>(Wall::now() - asked_at_).count() : 0;
}

void Manipulator::pass_errors_on() {
  if (!errors_) return;
  std::string_view line;
  // when nobody reads our errors, the program waits
  while (manager_.errors().pending() < unread_errors) {
    using Next = channel::LineBuffer::Next;
    switch (errors_->lines().next(line)) {
      case Next::line:
      case Next::half: manager_.errors().write(name + ": " + std::string(line) + "\n"); break;
      case Next::too_long: manager_.errors().write(name + ": (a line too long to show)\n"); break;
      case Next::end: return;
      case Next::none:
        errors_->want();
        if (!errors_->lines().has_line() && !errors_->at_end()) return;
        break;
    }
  }
}

// -- what it declares

void Manipulator::declaration(std::string_view line) {
  if (Status split = words_.split(line); !split) {
    give_up({split.error().kind, name + " said: " + split.error().sentence, 0});
    return;
  }
  if (words_.empty()) return;
  if (Status status = declare(words_.words(), line); !status)
    give_up({status.error().kind,
             name + ": " + status.error().sentence + " (in: " + std::string(line.substr(0, 200)) + ")", 0});
}

Status Manipulator::declare(Words words, std::string_view line) {
  const std::string_view verb = words[0].text;
  if (verb == "ready") {
    became_ready();
    return {};
  }
  if (verb == "verb" && words.size() > 1) {
    if (find_command(words[1].text) != nullptr)
      return error_at(words[1], ErrorKind::exists, "verb " + std::string(words[1].text) + " is the manager's own");
    for (const auto& other : manager_.manipulators())
      for (const Verb& known : other->verbs())
        if (other.get() != this && known.name == words[1].text && other->program() != program() &&
            other->state() != State::failed)
          return error_at(words[1], ErrorKind::exists, "verb " + known.name + " is offered by " + other->name);
  }
  if (Status taken = declaring_.take(words, manager_.world); !taken) return taken;
  if ((verb == "type" || verb == "field") && !briefing_.begun()) manager_.journal(*this, "", line);
  return {};
}

void Manipulator::became_ready() {
  deadline_.reset();
  state_ = State::ready;
  declared_ = std::move(declaring_);
  if (!briefing_.begun()) {
    if (Status arranged = manager_.arrange_stages(); !arranged) {
      give_up(arranged.error());
      return;
    }
    manager_.schema_changed();
    Tale tale;
    briefing_.begin(id, tale);
    tell(tale);
    state_ = State::active;
    if (manager_.budget().of != Manager::Budget::Of::nothing) tell_budget();
    return;
  }
  state_ = State::active;
  const bool afresh = log_.lost();
  tell_again();
  manager_.event("event restarted " + name + (afresh ? " afresh" : ""));
}

// -- what it says

void Manipulator::receive(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (state_ == State::handshaking) {
    declaration(line);
    return;
  }
  if (repetition_.under_way()) {
    // as long as it comes nearer it is given time
    set_deadline();
    if (repetition_.heard_before(line)) return;
  }
  if (line.starts_with("put ") && !fill(line)) return;
  if (line.starts_with("done") && (line.size() == 4 || line[4] == ' '))
    done(line);
  else if (line.starts_with("@"))
    reply_line(line);
  else if (line.starts_with("  "))
    reply_body_.append(line.substr(2)).append("\n");
  else if (answering())
    keep_for_later(line);
  else
    said(line);
}

void Manipulator::done(std::string_view line) {
  const std::optional<std::uint64_t> tick = line.size() > 5 ? parse_count(line.substr(5)) : std::nullopt;
  if (writing_down_ && line.size() == 4) {
    writing_down_ = false;
    lost_checkpoints_ = 0;
  } else if (tick && awaited_ && *tick == *awaited_) {
    awaited_.reset();
    strikes_ = 0;
    repetition_.finished(line);
    last_ms_ = std::chrono::duration<double, std::milli>(Wall::now() - asked_at_).count();
  } else {
    refuse({ErrorKind::range,
            "done " + std::string(line.substr(std::min<std::size_t>(5, line.size()))) +
                (awaited_        ? ", expected done " + std::to_string(*awaited_)
                 : writing_down_ ? ", expected done after a checkpoint"
                                 : ", though no tick is under way"),
            1});
    return;
  }
  answered_ = true;
  refused_in_row_ = 0;
  set_deadline();
}

// what it says in a tick counts when the tick's turn comes
void Manipulator::keep_for_later(std::string_view line) {
  // what is no command at all is refused at once, so that garbage does not grow until the end of the tick
  const std::string_view verb = line.substr(0, line.find_first_of(" \t"));
  if (!line.empty() && line[0] != '#' && find_command(verb) == nullptr)
    refuse({ErrorKind::unknown, "no verb " + quote(verb.substr(0, 60)), 1});
  else if (answer_.size() > longest_answer)
    refuse({ErrorKind::limit, "more than " + std::to_string(longest_answer) + " bytes in one tick", 1});
  else
    answer_.append(line).append("\n");
}

void Manipulator::said(std::string_view line) {
  if (Status split = words_.split(line); !split) {
    refuse(split.error());
    return;
  }
  if (words_.empty()) return;
  if (!manager_.tick_in_flight()) repetition_.spoke();
  std::string body;
  const Outcome outcome = manager_.execute(*this, nullptr, words_, line, {}, body);
  if (!outcome.status) {
    refuse(outcome.status.error());
    return;
  }
  refused_in_row_ = 0;
  note_long(line);
  // a program may ask too; its answers look like everyone's
  std::string_view rest = body;
  while (!rest.empty() && input_) {
    const std::size_t end = std::min(rest.find('\n'), rest.size() - 1);
    input_->buffer().append("  ").append(rest.substr(0, end + 1));
    rest.remove_prefix(end + 1);
  }
  if (!words_.tag().empty() && input_) input_->buffer().append("@").append(words_.tag()).append(" ok\n");
}

void Manipulator::refuse(const Error& error) {
  ++refused_;
  ++refused_in_row_;
  const std::string text = "error " + std::string(name_of(error.kind)) + " " +
                           std::to_string(std::max(error.column, 1)) + " " + error.sentence;
  if (input_) {
    input_->write(text + "\n");
    input_->flush();
  }
  if (refused_in_row_ <= 20 && manager_.errors().pending() < 4 * unread_errors)
    manager_.errors().write(name + ": refused: " + text.substr(6) + "\n");
  if (refused_in_row_ < refusals_in_a_row || !alive()) return;
  refused_in_row_ = 0;
  end_by_force("garbage");
}

void Manipulator::reply_line(std::string_view line) {
  // "@7 ok" or "@7 error KIND COLUMN sentence"
  const std::size_t blank = line.find(' ');
  const std::optional<std::uint64_t> number =
      parse_count(line.substr(1, blank == std::string_view::npos ? blank : blank - 1));
  std::string body = std::move(reply_body_);
  reply_body_.clear();
  for (auto& [asked, reply] : requests_) {
    if (!number || asked != *number || reply) continue;
    const std::string_view rest = blank == std::string_view::npos ? std::string_view() : line.substr(blank + 1);
    reply = Reply{std::move(body), rest.starts_with("error") ? Status(parse_error(rest)) : Status()};
    repetition_.finished(line);
    set_deadline();
    return;
  }
  // a second answer after a restart is nothing to complain about
  if (!number || *number >= next_request_ || (restarts_ == 0 && !resumed_))
    refuse({ErrorKind::unknown, "no command waits for " + std::string(line.substr(0, blank)), 1});
}

Status Manipulator::may_write(const Object& object, int index) {
  const Field& field = object.type->field(index);
  const bool declared = ((field.is_private || field.measured) && declared_.brought(*object.type)) ||
                        std::any_of(declared_.writes().begin(), declared_.writes().end(), [&](const auto& access) {
                          if (!access.field.empty() && access.field != field.name) return false;
                          const Type* type = manager_.world.schema().find(access.type);
                          return type != nullptr && object.type->is(*type);
                        });
  if (!declared)
    return Error{ErrorKind::owner, name + " did not declare that it writes " + object.type->name() + "." + field.name,
                 0};
  if (!briefing_.serves(object))
    return Error{ErrorKind::owner, object.path + " is not served by " + name + " (serving " + briefing_.serving() + ")",
                 0};
  const std::uint16_t owner = object.slots[static_cast<std::size_t>(index)].owner;
  if (owner == id) return {};
  if (owner != 0)
    return Error{ErrorKind::owner,
                 object.path + "." + field.name + " is written by " + manager_.source_name(owner) +
                     " already, expected one writer a field",
                 0};
  manager_.world.set_owner(object, index, id);
  briefing_.owns(object, index);
  return {};
}

Status Manipulator::may_make(const Object& object) {
  const bool declared = declared_.brought(*object.type) ||
                        std::any_of(declared_.writes().begin(), declared_.writes().end(), [&](const auto& access) {
                          const Type* type = manager_.world.schema().find(access.type);
                          return access.field.empty() && type != nullptr && object.type->is(*type);
                        });
  if (!declared)
    return Error{ErrorKind::owner,
                 name + " did not declare that it writes " + object.type->name() + ": " + object.path +
                     " is not its own to make or delete",
                 0};
  if (!serves_path(object.path))
    return Error{ErrorKind::owner, object.path + " is not served by " + name + " (serving " + briefing_.serving() + ")",
                 0};
  return {};
}

// -- what it is told

void Manipulator::say(std::string_view text) {
  // while it is restarted the log is all it needs
  if (input_ && state_ == State::active && !manager_.replaying()) input_->write(text);
}

void Manipulator::tell(const Tale& tale) {
  if (tale.empty()) return;
  log_.world(tale);
  if (input_ && state_ != State::handshaking && !manager_.replaying()) tale.append_to(input_->buffer());
}

void Manipulator::tell_to_act(std::string_view line) {
  log_.act(line);
  say(line);
}

void Manipulator::tell_changes() {
  if (!briefing_.begun()) return;
  Tale tale;
  briefing_.changes(tale, manager_.in_tick() ? manager_.clock.tick() + 1 : 0,
                    !manager_.replaying() && state_ == State::active);
  tell(tale);
}

// its part of the world as it stands, in the place of all that it was told
void Manipulator::forget_the_past() {
  Tale whole, own;
  if (budget_told_) whole.text = manager_.budget().line() + "\n";
  briefing_.whole(whole);
  briefing_.own(own);
  log_.begin();
  log_.checkpoint(own, &whole);
}

// everything it was told, once more; what it answers up to where it was has been carried out
void Manipulator::tell_again() {
  if (answering()) {
    answer_.clear();
    filled_.clear();
    answered_ = false;
  }
  reply_body_.clear();
  if (log_.lost()) {
    tell_changes();
    forget_the_past();
    repetition_.forget();
    if (awaited_) log_.act(tick_line_);
  }
  repetition_.begin();
  input_->write(log_.retell(manager_.world));
  if (writing_down_) input_->write("checkpoint\n");
  input_->flush();
  set_deadline();
}

void Manipulator::tell_budget() {
  if (!briefing_.begun()) return;
  budget_told_ = true;
  tell({manager_.budget().line() + "\n", {}});
}

// -- ticks

bool Manipulator::due(std::uint64_t tick, double manager_rate) const {
  if (state_ == State::failed || state_ == State::ended || state_ == State::starting || !briefing_.begun())
    return false;
  if (rate() <= 0 || rate() >= manager_rate) return true;
  const double ratio = rate() / manager_rate;
  return std::floor(static_cast<double>(tick) * ratio + 1e-9) >
         std::floor(static_cast<double>(tick - 1) * ratio + 1e-9);
}

void Manipulator::send_tick(std::uint64_t tick, double time, double step) {
  tell_changes();
  const double own_step = last_tick_ == 0 ? (rate() > 0 ? std::max(step, 1 / rate()) : step)
                                          : static_cast<double>(tick - last_tick_) * step;
  if (first_tick_ == 0) first_tick_ = tick;
  last_tick_ = tick;
  answer_.clear();
  answered_ = false;
  asked_at_ = Wall::now();
  if (manager_.replaying())
    repetition_.finished("done " + std::to_string(tick));
  else
    awaited_ = tick;
  tick_line_ = "tick " + std::to_string(tick) + " " + number(time) + " " + number(own_step) + "\n";
  tell_to_act(tick_line_);
  set_deadline();
  flush();
}

void Manipulator::abandon_tick() {
  awaited_.reset();
  writing_down_ = false;
  answered_ = false;
  answer_.clear();
}

void Manipulator::apply_answer() {
  if (!answered_) return;
  answered_ = false;
  const std::string answer = std::move(answer_);
  answer_.clear();
  for_each_line(answer, [this](std::string_view line) { said(line); });
  filled_.clear();
  grant();
  flush();
}

// -- arrays in shared memory

// "put PATH.FIELD slot=K seq=N": the numbers are taken as soon as they are announced. False: it was refused.
bool Manipulator::fill(std::string_view line) {
  const Status read = read_filled(line);
  if (!read) refuse(read.error());
  return read.ok();
}

Status Manipulator::read_filled(std::string_view line) {
  if (Status split = words_.split(line); !split) return split;
  const Words words = words_.words();
  std::uint64_t slot = 0, sequence = 0;
  if (Status parsed = parse_put(words, slot, sequence); !parsed) return parsed;
  const auto found = granted_.find(words[1].text);
  if (found == granted_.end() || !found->second.memory)
    return error_at(words[1], ErrorKind::owner,
                    name + " was given no memory for " + shown(words[1].text) + ", expected its value as text");
  Granted& granted = found->second;
  if (sequence != granted.sequence + 1)
    return error_at(words[3], ErrorKind::range,
                    "seq is " + std::to_string(sequence) + ", expected " + std::to_string(granted.sequence + 1));
  if (slot != sequence % ArrayMemory::slots)
    return error_at(words[2], ErrorKind::range,
                    "slot is " + std::to_string(slot) + ", expected " + std::to_string(sequence % ArrayMemory::slots) +
                        " (seq modulo " + std::to_string(ArrayMemory::slots) + ")");
  Result<std::vector<double>> numbers = granted.memory->read(sequence);
  if (!numbers) return error_at(words[1], numbers.error().kind, numbers.error().sentence);
  granted.sequence = sequence;
  filled_.push_back({std::string(words[1].text), sequence, granted.memory, std::move(*numbers)});
  return {};
}

Result<Manipulator::Filled> Manipulator::take_filled(std::string_view target, std::uint64_t sequence) {
  const auto found = std::find_if(filled_.begin(), filled_.end(), [&](const Filled& each) {
    return each.target == target && each.sequence == sequence;
  });
  if (found == filled_.end())
    return Error{ErrorKind::unknown, "seq " + std::to_string(sequence) + " of " + shown(target) + " is not filled", 0};
  Filled filled = std::move(*found);
  filled_.erase(found);
  return filled;
}

// what it said as a long text it could say shorter
void Manipulator::note_long(std::string_view line) {
  if (!declared_.shares_arrays() || line.size() < 2 * long_array || !line.starts_with("set ")) return;
  const Result<Target> target = parse_target(words_.words()[1]);
  if (target) long_sets_.insert(std::string(target->pattern) + "." + std::string(target->field));
}

void Manipulator::grant() {
  for (const std::string& name_of_field : std::exchange(long_sets_, {})) {
    const std::size_t dot = name_of_field.find('.');
    const Object* object = manager_.world.find(std::string_view(name_of_field).substr(0, dot));
    const int field = object == nullptr ? -1 : object->type->find(std::string_view(name_of_field).substr(dot + 1));
    if (field < 0 || !is_long(object->value(field))) continue;
    const std::size_t wanted = std::get<std::vector<double>>(object->value(field)).size();
    Granted& granted = granted_[name_of_field];
    if (granted.wanted >= wanted) continue;
    granted.wanted = wanted;
    Result<std::shared_ptr<ArrayMemory>> made = ArrayMemory::make(wanted);
    if (!made) {
      // it goes on as text
      manager_.event("event array " + name_of_field + " stays text: " + made.error().sentence);
      continue;
    }
    granted.memory = std::move(*made);
    granted.sequence = 0;
    manager_.arrays.forget_dead(manager_.world);
    say("array " + name_of_field + " fill=" + granted.memory->path() + " capacity=" + std::to_string(wanted) + "\n");
  }
}

// -- checkpoints

bool Manipulator::wants_checkpoint(std::uint64_t tick, double manager_rate) const {
  if (!declared_.checkpoints() || state_ != State::active || lost_checkpoints_ >= checkpoints_lost_allowed ||
      first_tick_ == 0 || !due(tick, manager_rate))
    return false;
  // a journal that is followed says when
  if (manager_.following_journal()) return checkpoint_wanted_;
  const Manager::Checkpoints& every = manager_.checkpoints;
  const std::uint64_t since = last_tick_ - std::max(first_tick_ - 1, checkpoint_tick_);
  return checkpoint_wanted_ || (every.ticks > 0 && since >= every.ticks) ||
         (every.bytes > 0 && log_.since() >= every.bytes);
}

void Manipulator::ask_checkpoint() {
  tell_changes();
  checkpoint_wanted_ = false;
  writing_down_ = true;
  answer_.clear();
  answered_ = false;
  asked_at_ = Wall::now();
  say("checkpoint\n");
  set_deadline();
  flush();
}

// a value that is part of a checkpoint
bool Manipulator::writes_down(std::string_view line) {
  if (!words_.split(line) || words_.empty() || words_.words()[0].text != "set" || words_.words().size() < 2)
    return false;
  const Result<Target> target = parse_target(words_.words()[1]);
  const Object* object = target ? manager_.world.find(target->pattern) : nullptr;
  const int field = object == nullptr ? -1 : object->type->find(target->field);
  return field >= 0 && object->type->field(field).is_private;
}

void Manipulator::apply_checkpoint() {
  if (!answered_) return;
  answered_ = false;
  const std::string answer = std::move(answer_);
  answer_.clear();
  const std::uint64_t refused = refused_;
  std::string rest;
  manager_.journal_checkpoint(name, false);
  for_each_line(answer, [&](std::string_view line) {
    if (writes_down(line))
      said(line);
    else
      rest.append(line).append("\n");
  });
  checkpoint_tick_ = last_tick_;
  if (refused == refused_) {
    manager_.journal_checkpoint(name, true);
    checkpoint_before(true);
  }
  // whatever else it says has waited
  for_each_line(rest, [this](std::string_view line) { said(line); });
  flush();
}

// -- a life that is made again from a journal

void Manipulator::checkpoint_before(bool ended) {
  written_before_ = !ended;
  if (!ended) {
    tell_changes();
    return;
  }
  checkpoint_tick_ = last_tick_;
  if (log_.lost() || log_.wants_whole()) {
    forget_the_past();
  } else {
    Tale own;
    briefing_.own(own);
    log_.checkpoint(own, nullptr);
  }
  repetition_.forget();
}

void Manipulator::spoke_before() {
  if (!written_before_) repetition_.spoke();
}

void Manipulator::catch_up() {
  written_before_ = false;
  if (!input_ || !briefing_.begun()) return;
  resumed_ = true;
  tell_again();
}

void Manipulator::asked_before(std::uint64_t number, std::string_view line) {
  tell_changes();
  next_request_ = number + 1;
  repetition_.asked();
  tell_to_act("@" + std::to_string(number) + " " + std::string(line) + "\n");
}

// -- its verbs

std::uint64_t Manipulator::ask(std::string_view line) {
  tell_changes();
  const std::uint64_t number = next_request_++;
  requests_.emplace_back(number, std::nullopt);
  repetition_.asked();
  asked_at_ = Wall::now();
  tell_to_act("@" + std::to_string(number) + " " + std::string(line) + "\n");
  set_deadline();
  flush();
  return number;
}

std::size_t Manipulator::asked() const {
  return static_cast<std::size_t>(
      std::count_if(requests_.begin(), requests_.end(), [](const auto& each) { return !each.second; }));
}

std::optional<Manipulator::Reply> Manipulator::take_reply(std::uint64_t number) {
  for (auto each = requests_.begin(); each != requests_.end(); ++each) {
    if (each->first != number) continue;
    if (!each->second) return std::nullopt;
    Reply reply = std::move(*each->second);
    requests_.erase(each);
    return reply;
  }
  return Reply{{}, Error{ErrorKind::gone, name + " is gone", 0}};
}

std::size_t Manipulator::queued() const { return input_ ? input_->pending() : 0; }

void Manipulator::flush() {
  if (!input_) return;
  input_->flush();
  // the end of its input is a second way to say quit
  if (quitting_ && input_->pending() == 0) input_.reset();
}

}  // namespace manager
