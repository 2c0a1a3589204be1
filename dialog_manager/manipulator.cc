#include "dialog_manager/manipulator.h"

#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <csignal>

#include "dialog_manager/manager.h"

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
// without a checkpoint a restart needs every line told so far; beyond this it is given up
constexpr std::size_t unread_errors = 1u << 20;
constexpr std::size_t longest_answer = 64u << 20;
constexpr std::size_t longest_log = 256u << 20;

Error error_at(const Word& word, ErrorKind kind, std::string sentence) {
  return {kind, std::move(sentence), word.column};
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Manipulator::Manipulator(Manager& manager, std::string program_name, std::string program, std::vector<std::string> argv,
                         std::string serving)
    : manager_(manager), program_(std::move(program)), argv_(std::move(argv)), serving_(std::move(serving)) {
  name = std::move(program_name);
  gate = this;
}

Manipulator::~Manipulator() {
  if (alive()) kill();
  close_process();
  if (subscribed_) manager_.world.unsubscribe(feed_);
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
  reads_.clear();
  writes_.clear();
  verbs_.clear();
  own_types_.clear();
  interests_.clear();
  hello();
  return {};
}

void Manipulator::hello() {
  std::string line = "hello protocol=1 name=" + name + " seed=" + std::to_string(manager_.options().seed) +
                     " tick=" + number(manager_.clock.step()) + " arrays=text schema=";
  static constexpr char digits[] = "0123456789abcdef";
  const std::uint64_t schema = manager_.world.schema().hash();
  for (int shift = 60; shift >= 0; shift -= 4) line += digits[(schema >> shift) & 15];
  input_->write(line + "\n");
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

void Manipulator::died(const std::string& how) {
  close_process();
  deadline_.reset();
  if (quitting_) {
    state_ = State::ended;
    return;
  }
  manager_.event("event gone " + name + " " + how);
  if (state_ == State::handshaking && restarts_ == 0 && !subscribed_) {
    give_up({ErrorKind::gone, name + " ended with " + how + " before it was ready", 0});
    return;
  }
  ++strikes_;
  while (!starts_.empty() && Wall::now() - starts_.front() > starts_window) starts_.pop_front();
  if (strikes_ >= strikes_allowed || static_cast<int>(starts_.size()) > starts_allowed || !log_whole_) {
    give_up({how == "timeout" ? ErrorKind::timeout : ErrorKind::gone,
             name + " ended with " + how + " at tick " + std::to_string(last_tick_) + ", " + std::to_string(strikes_) +
                 (strikes_ == 1 ? " time" : " times in a row"),
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
  if (!subscribed_) return;
  // changes are not kept for who will not hear of them
  manager_.world.unsubscribe(feed_);
  subscribed_ = false;
  if (policy_ == Policy::stop) manager_.break_tick(failure_);
}

// -- what it says

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
  if (!alive()) return true;
  if (ended) {
    // the end of its words is its end: what is left of it and of its children goes with it
    std::string how = channel::reap(process_.pid);
    if (how.empty()) {
      if (!exited_) {
        // a moment to end by itself, so that its exit status can be told
        for (int i = 0; i < 20 && how.empty(); ++i) {
          ::usleep(1000);
          how = channel::reap(process_.pid);
        }
      }
      if (how.empty()) {
        ::kill(-process_.pid, SIGKILL);
        ::waitpid(process_.pid, nullptr, 0);
        how = "closed output";
      }
    }
    ::kill(-process_.pid, SIGKILL);
    process_.pid = -1;
    died(how);
    return true;
  }
  return did;
}

std::optional<Wall::time_point> Manipulator::deadline() const { return restart_at_ ? restart_at_ : deadline_; }

void Manipulator::check_deadline() {
  if (!deadline_ || Wall::now() < *deadline_ || !alive()) return;
  if (state_ == State::handshaking && restarts_ == 0 && !subscribed_) {
    give_up({ErrorKind::timeout, name + " did not say ready in 10 s", 0});
    return;
  }
  ::kill(-process_.pid, SIGKILL);
  ::waitpid(process_.pid, nullptr, 0);
  process_.pid = -1;
  died("timeout");
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

void Manipulator::receive(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (state_ == State::handshaking) {
    declaration(line);
    return;
  }
  if (line.starts_with("done") && (line.size() == 4 || line[4] == ' ')) {
    const std::optional<std::uint64_t> tick = line.size() > 5 ? parse_count(line.substr(5)) : std::nullopt;
    if (replaying_) {
      if (tick && *tick == *replaying_) replaying_.reset();
      return;
    }
    if (tick && awaited_ && *tick == *awaited_) {
      awaited_.reset();
      answered_ = true;
      strikes_ = 0;
      refused_in_row_ = 0;
      spoken_ = 0;
      to_drop_ = 0;
      deadline_.reset();
      last_ms_ = std::chrono::duration<double, std::milli>(Wall::now() - asked_at_).count();
      return;
    }
    refuse({ErrorKind::range,
            "done " + std::string(line.substr(std::min<std::size_t>(5, line.size()))) +
                (awaited_ ? ", expected done " + std::to_string(*awaited_) : ", though no tick is under way"),
            1});
    return;
  }
  if (line.starts_with("@")) {
    reply_line(line);
    return;
  }
  if (line.starts_with("  ")) {
    reply_body_.append(line.substr(2)).append("\n");
    return;
  }
  // after a restart it says again what was carried out before
  if (replaying_) return;
  if (to_drop_ > 0) {
    --to_drop_;
    return;
  }
  if (!awaited_) {
    said(line);
    return;
  }
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
  if (!manager_.tick_in_flight()) ++spoken_;
  std::string body;
  const Outcome outcome = manager_.execute(*this, nullptr, words_, line, {}, body);
  if (!outcome.status) {
    refuse(outcome.status.error());
    return;
  }
  refused_in_row_ = 0;
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
  ::kill(-process_.pid, SIGKILL);
  ::waitpid(process_.pid, nullptr, 0);
  process_.pid = -1;
  died("garbage");
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
    reply.emplace();
    reply->body = std::move(body);
    std::string_view rest = blank == std::string_view::npos ? std::string_view() : line.substr(blank + 1);
    if (rest.starts_with("error")) {
      rest.remove_prefix(std::min<std::size_t>(6, rest.size()));
      Error error{ErrorKind::io, std::string(rest), 0};
      for (int kind = 0; kind <= static_cast<int>(ErrorKind::io); ++kind) {
        const std::string_view word = name_of(static_cast<ErrorKind>(kind));
        if (!rest.starts_with(word) || rest.size() <= word.size() || rest[word.size()] != ' ') continue;
        error.kind = static_cast<ErrorKind>(kind);
        error.sentence = rest.substr(word.size() + 1);
        // an optional column of the forwarded line
        const std::size_t digits = error.sentence.find_first_not_of("0123456789");
        if (digits != 0 && digits != std::string::npos && error.sentence[digits] == ' ') {
          error.column = static_cast<int>(parse_count(std::string_view(error.sentence).substr(0, digits)).value_or(0));
          error.sentence.erase(0, digits + 1);
        }
        break;
      }
      reply->status = std::move(error);
    }
    deadline_.reset();
    return;
  }
  // a second answer after a restart is nothing to complain about
  if (!replaying_ && restarts_ == 0)
    refuse({ErrorKind::unknown, "no command waits for " + std::string(line.substr(0, blank)), 1});
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
  const Words rest = words.subspan(1);
  const auto expect = [&](bool good, std::string_view syntax) -> Status {
    if (good) return {};
    return error_at(words.back(), ErrorKind::syntax, "expected " + std::string(syntax));
  };
  const auto quantity = [&](std::string_view dimension) -> Result<double> {
    if (rest.size() != 1)
      return error_at(words.back(), ErrorKind::syntax, "expected " + std::string(verb) + " and one number");
    return parse_real(rest[0].text, parse_unit(dimension)->dimension);
  };
  if (verb == "type") {
    const Result<const Type*> type = manager_.world.declare_type(rest);
    if (!type) return type.error();
    own_types_.push_back(*type);
    manager_.journal(*this, "", line);
    return {};
  }
  if (verb == "field") {
    const Result<const Field*> field = manager_.world.declare_field(rest);
    if (!field) return field.error();
    manager_.journal(*this, "", line);
    return {};
  }
  if (verb == "verb") {
    if (Status good =
            expect(rest.size() >= 1 && rest.size() <= 3 && is_name(rest[0].text), "verb NAME \"SYNTAX\" \"doc\"");
        !good)
      return good;
    if (find_command(rest[0].text) != nullptr)
      return error_at(rest[0], ErrorKind::exists, "verb " + std::string(rest[0].text) + " is the manager's own");
    for (const auto& other : manager_.manipulators())
      for (const Verb& known : other->verbs())
        if (other.get() != this && known.name == rest[0].text && other->program() != program() &&
            other->state() != State::failed)
          return error_at(rest[0], ErrorKind::exists, "verb " + known.name + " is offered by " + other->name);
    verbs_.push_back({std::string(rest[0].text), rest.size() > 1 ? std::string(rest[1].text) : "",
                      rest.size() > 2 ? std::string(rest[2].text) : ""});
    return {};
  }
  if (verb == "reads" || verb == "writes") {
    if (Status good = expect(!rest.empty(), std::string(verb) + " TYPE.FIELD ..."); !good) return good;
    const bool delayed = verb == "reads" && rest.back().text == "delayed";
    for (const Word& word : delayed ? rest.first(rest.size() - 1) : rest) {
      const std::size_t dot = word.text.find('.');
      Access access{std::string(word.text.substr(0, dot)),
                    dot == std::string_view::npos ? "" : std::string(word.text.substr(dot + 1)), delayed};
      if (!is_name(access.type) || (dot != std::string_view::npos && !is_name(access.field)))
        return error_at(word, ErrorKind::syntax, quote(word.text) + " is not TYPE.FIELD");
      // a type that another program will bring may still be unknown; a wrong field of a known one is an error
      if (manager_.world.schema().find(access.type) != nullptr)
        if (!access.field.empty())
          if (const Result<const Field*> field = manager_.world.schema().field(word); !field) return field.error();
      (verb == "reads" ? reads_ : writes_).push_back(std::move(access));
    }
    return {};
  }
  if (verb == "rate") {
    const Result<double> value = quantity("Hz");
    if (!value) return value.error();
    if (!(*value > 0))
      return error_at(rest[0], ErrorKind::range, "rate is " + std::string(rest[0].text) + ", expected more than 0");
    rate_ = *value;
    return {};
  }
  if (verb == "timeout") {
    const Result<double> value = quantity("s");
    if (!value) return value.error();
    if (!(*value > 0 && *value < 1e6))
      return error_at(rest[0], ErrorKind::range, "timeout is " + std::string(rest[0].text) + ", expected 0 to 1e6 s");
    timeout_ = std::chrono::milliseconds(static_cast<long>(std::ceil(*value * 1000)));
    return {};
  }
  if (verb == "policy") {
    if (rest.size() == 1 && rest[0].text == "stop")
      policy_ = Policy::stop;
    else if (rest.size() == 1 && rest[0].text == "hold")
      policy_ = Policy::hold;
    else if (rest.size() == 1 && rest[0].text == "skip")
      policy_ = Policy::skip;
    else
      return error_at(words.back(), ErrorKind::syntax, "expected policy stop, hold or skip");
    return {};
  }
  if (verb == "arrays=text" || verb == "arrays=shm") return {};
  if (verb == "ready") {
    became_ready();
    return {};
  }
  return error_at(words[0], ErrorKind::unknown,
                  quote(verb.substr(0, 60)) +
                      " is no declaration (type field verb reads writes rate timeout policy arrays=text ready)");
}

void Manipulator::became_ready() {
  deadline_.reset();
  state_ = State::ready;
  interests_.clear();
  if (!subscribed_) {
    if (Status arranged = manager_.arrange_stages(); !arranged) {
      give_up(arranged.error());
      return;
    }
    manager_.schema_changed();
    feed_ = manager_.world.subscribe();
    subscribed_ = true;
    tell_world();
    return;
  }
  tell_again();
  state_ = State::active;
  manager_.event("event restarted " + name);
}

// everything it was told, once more; what it answers up to where it was has been carried out
void Manipulator::tell_again() {
  answer_.clear();
  reply_body_.clear();
  answered_ = false;
  if (awaited_)
    replaying_ = previous_tick_ > 0 ? std::optional(previous_tick_) : std::nullopt;
  else
    replaying_ = last_tick_ > 0 ? std::optional(last_tick_) : std::nullopt;
  to_drop_ = spoken_;
  input_->write(log_);
  input_->flush();
  if (awaited_ || std::any_of(requests_.begin(), requests_.end(), [](const auto& each) { return !each.second; }))
    deadline_ = Wall::now() + timeout_ + std::chrono::milliseconds(log_.size() / 1000);
}

void Manipulator::catch_up() {
  if (!input_ || !subscribed_) return;
  tell_again();
}

void Manipulator::asked_before(std::uint64_t number, std::string_view line) {
  tell_changes();
  next_request_ = number + 1;
  say("@" + std::to_string(number) + " " + std::string(line) + "\n");
}

bool Manipulator::declared_here(const Type& type) const {
  return std::any_of(own_types_.begin(), own_types_.end(), [&](const Type* own) { return type.is(*own); });
}

bool Manipulator::reads(const Field& field, bool* delayed) const {
  for (const Access& access : reads_) {
    const Type* type = manager_.world.schema().find(access.type);
    if (type == nullptr) continue;
    const bool inside = access.field.empty()
                            ? type->find(field) >= 0
                            : field.name == access.field && (type->is(*field.owner) || field.owner->is(*type));
    if (!inside) continue;
    if (delayed != nullptr) *delayed = access.delayed;
    return true;
  }
  return false;
}

bool Manipulator::reads_by_name(const Field& field, bool* delayed) const {
  for (const Access& access : reads_)
    if (access.field == field.name) {
      *delayed = access.delayed;
      return true;
    }
  return false;
}

bool Manipulator::writes(const Field& field) const {
  for (const Access& access : writes_) {
    const Type* type = manager_.world.schema().find(access.type);
    if (type == nullptr) continue;
    if (access.field.empty() ? type->find(field) >= 0
                             : field.name == access.field && (type->is(*field.owner) || field.owner->is(*type)))
      return true;
  }
  return false;
}

Status Manipulator::may_write(const Object& object, int index) {
  const Field& field = object.type->field(index);
  bool declared = (field.is_private || field.measured) && declared_here(*object.type);
  for (const Access& access : writes_) {
    if (declared) break;
    if (!access.field.empty() && access.field != field.name) continue;
    const Type* type = manager_.world.schema().find(access.type);
    declared = type != nullptr && object.type->is(*type);
  }
  if (!declared)
    return Error{ErrorKind::owner, name + " did not declare that it writes " + object.type->name() + "." + field.name,
                 0};
  if (!serves(object))
    return Error{ErrorKind::owner, object.path + " is not served by " + name + " (serving " + serving_ + ")", 0};
  const std::uint16_t owner = object.slots[static_cast<std::size_t>(index)].owner;
  if (owner == id) return {};
  if (owner != 0)
    return Error{ErrorKind::owner,
                 object.path + "." + field.name + " is written by " + manager_.source_name(owner) +
                     " already, expected one writer a field",
                 0};
  manager_.world.set_owner(object, index, id);
  return {};
}

Status Manipulator::may_make(const Object& object) {
  const bool declared =
      declared_here(*object.type) || std::any_of(writes_.begin(), writes_.end(), [&](const Access& access) {
        const Type* type = manager_.world.schema().find(access.type);
        return access.field.empty() && type != nullptr && object.type->is(*type);
      });
  if (!declared)
    return Error{ErrorKind::owner,
                 name + " did not declare that it writes " + object.type->name() + ": " + object.path +
                     " is not its own to make or delete",
                 0};
  if (!serves_path(object.path))
    return Error{ErrorKind::owner, object.path + " is not served by " + name + " (serving " + serving_ + ")", 0};
  return {};
}

// -- what it is told

void Manipulator::log(std::string_view line) {
  if (!log_whole_) return;
  log_ += line;
  if (log_.size() > longest_log) {
    log_whole_ = false;
    log_ = {};
  }
}

void Manipulator::say(std::string_view line) {
  log(line);
  // while it is restarted the log is all it needs
  if (input_ && state_ != State::handshaking && !manager_.replaying()) input_->write(line);
}

const Manipulator::Interest& Manipulator::interest(const Type& type) {
  Interest& known = interests_[&type];
  if (known.fields.size() == type.fields().size()) return known;
  known.fields.assign(type.fields().size(), 0);
  const bool own = declared_here(type);
  for (std::size_t i = 0; i < known.fields.size(); ++i) {
    const Field& field = *type.fields()[i];
    if (own && !field.derived) known.fields[i] = 1;
    for (const Access& access : reads_) {
      if (!access.field.empty() && access.field != field.name) continue;
      const Type* read = manager_.world.schema().find(access.type);
      if (read == nullptr || !type.is(*read)) continue;
      if (access.field.empty() && field.derived) continue;
      known.fields[i] = access.delayed ? 2 : 1;
    }
    known.any = known.any || known.fields[i] != 0;
  }
  return known;
}

void Manipulator::schema_changed() { interests_.clear(); }

bool Manipulator::serves(const Object& object) const {
  return serving_.empty() || !declared_here(*object.type) || matches(serving_, object.path);
}

void Manipulator::tell_world() {
  told_.clear();
  told_types_.clear();
  manager_.world.for_each("**", [&](const Object& object) {
    if (interest(*object.type).any && serves(object)) meet(object);
  });
  introduce();
  say(outgoing_);
  outgoing_.clear();
  state_ = State::active;
  if (manager_.budget().of != Manager::Budget::Of::nothing) tell_budget();
}

void Manipulator::meet_type(const Type& type) {
  const Schema& schema = manager_.world.schema();
  const auto types = schema.types();
  const auto found = std::find_if(types.begin(), types.end(), [&](const auto& each) { return each.get() == &type; });
  const auto index = static_cast<std::size_t>(found - types.begin());
  if (index < schema.built_in()) return;
  if (told_types_.size() <= index) told_types_.resize(index + 1);
  if (told_types_[index]) return;
  told_types_[index] = true;
  if (type.base() != nullptr) meet_type(*type.base());
  if (std::find(own_types_.begin(), own_types_.end(), &type) != own_types_.end()) return;
  outgoing_ += "type " + type.name() + (type.base() == nullptr ? "" : " extends " + type.base()->name()) + "\n";
  const Interest& wanted = interest(type);
  for (std::size_t i = 0; i < type.fields().size(); ++i) {
    const Field& field = *type.fields()[i];
    if (field.owner != &type || wanted.fields[i] == 0) continue;
    if (field.ref_type != nullptr) meet_type(*field.ref_type);
    outgoing_ += field.declaration() + "\n";
  }
}

void Manipulator::meet_targets(const Field& field, const Value& value) {
  if (!field.holds_refs()) return;
  const auto visit = [&](std::int64_t target) {
    if (const Object* object = manager_.world.object(static_cast<ObjectId>(target))) meet(*object);
  };
  if (const auto* one = std::get_if<std::int64_t>(&value)) visit(*one);
  if (const auto* many = std::get_if<std::vector<std::int64_t>>(&value))
    for (const std::int64_t each : *many) visit(each);
}

// an object brings along what it stands below and what its references name
void Manipulator::meet(const Object& object) {
  if (told(object.id)) return;
  if (told_.size() <= object.id) told_.resize(object.id + 1);
  told_[object.id] = true;
  fresh_.push_back(&object);
  if (const Object* parent = manager_.world.object(object.parent)) meet(*parent);
  meet_type(*object.type);
  const Interest& wanted = interest(*object.type);
  for (std::size_t i = 0; i < object.slots.size(); ++i)
    if (wanted.fields[i] != 0) meet_targets(*object.type->fields()[i], object.slots[i].value);
}

void Manipulator::introduce() {
  std::sort(fresh_.begin(), fresh_.end(), [](const Object* a, const Object* b) { return a->id < b->id; });
  append_objects(outgoing_, manager_.world, fresh_, [&](const Object& object, const Field& field) {
    return interest(*object.type).fields[static_cast<std::size_t>(object.type->find(field))] != 0;
  });
  for (const Object* object : fresh_) {
    const Interest& wanted = interest(*object->type);
    for (std::size_t i = 0; i < object->slots.size(); ++i)
      if (wanted.fields[i] != 0 && object->type->fields()[i]->derived)
        append_set(outgoing_, manager_.world, *object, static_cast<int>(i));
  }
}

void Manipulator::tell_changes() {
  if (!subscribed_) return;
  // what a delayed read held back in the last tick comes first
  std::vector<std::pair<ObjectId, int>> held = std::move(deferred_);
  deferred_.clear();

  std::vector<std::pair<const Object*, int>> changes;
  fresh_.clear();
  manager_.world.read_feed(feed_, [&](const Database::Event& event, const Object& object) {
    if (event.field == Database::Event::deleted) {
      if (!told(event.object)) return;
      // references to it go with it
      outgoing_ += "delete " + object.path + " force\n";
      told_[event.object] = false;
      return;
    }
    const Interest& wanted = interest(*object.type);
    if (event.field == Database::Event::created || !told(object.id)) {
      const bool of_interest = event.field == Database::Event::created
                                   ? wanted.any
                                   : wanted.fields[static_cast<std::size_t>(event.field)] != 0;
      if (of_interest && serves(object)) meet(object);
    } else if (wanted.fields[static_cast<std::size_t>(event.field)] != 0) {
      changes.emplace_back(&object, event.field);
    }
  });
  for (const auto& [object, field] : changes) meet_targets(object->type->field(field), object->value(field));
  introduce();

  for (const auto& [held_id, field] : held)
    if (const Object* object = manager_.world.object(held_id); object != nullptr && told(held_id))
      append_set(outgoing_, manager_.world, *object, field);
  for (const auto& [object, field] : changes) {
    if (std::binary_search(fresh_.begin(), fresh_.end(), object,
                           [](const Object* a, const Object* b) { return a->id < b->id; }))
      continue;
    const Slot& slot = object->slots[static_cast<std::size_t>(field)];
    const bool derived = object->type->field(field).derived;
    // nobody is told its own words
    if (slot.origin.source == id && !derived) continue;
    const bool delayed = interest(*object->type).fields[static_cast<std::size_t>(field)] == 2;
    if (delayed && manager_.tick_in_flight() && slot.origin.tick == manager_.clock.tick() + 1)
      deferred_.emplace_back(object->id, field);
    else
      append_set(outgoing_, manager_.world, *object, field);
  }
  fresh_.clear();
  say(outgoing_);
  outgoing_.clear();
}

bool Manipulator::due(std::uint64_t tick, double manager_rate) const {
  if (state_ == State::failed || state_ == State::ended || state_ == State::starting || !subscribed_) return false;
  if (rate_ <= 0 || rate_ >= manager_rate) return true;
  const double ratio = rate_ / manager_rate;
  return std::floor(static_cast<double>(tick) * ratio + 1e-9) >
         std::floor(static_cast<double>(tick - 1) * ratio + 1e-9);
}

void Manipulator::send_tick(std::uint64_t tick, double time, double step) {
  tell_changes();
  const double own_step =
      last_tick_ == 0 ? (rate_ > 0 ? std::max(step, 1 / rate_) : step) : static_cast<double>(tick - last_tick_) * step;
  previous_tick_ = last_tick_;
  last_tick_ = tick;
  answer_.clear();
  answered_ = false;
  asked_at_ = Wall::now();
  if (manager_.replaying()) {
    spoken_ = 0;
  } else {
    awaited_ = tick;
    if (state_ == State::active) deadline_ = asked_at_ + timeout_;
  }
  say("tick " + std::to_string(tick) + " " + number(time) + " " + number(own_step) + "\n");
  flush();
}

void Manipulator::abandon_tick() {
  awaited_.reset();
  answered_ = false;
  answer_.clear();
}

void Manipulator::apply_answer() {
  if (!answered_) return;
  answered_ = false;
  const std::string answer = std::move(answer_);
  answer_.clear();
  std::string_view rest = answer;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    said(rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  flush();
}

std::uint64_t Manipulator::ask(std::string_view line) {
  tell_changes();
  const std::uint64_t number = next_request_++;
  requests_.emplace_back(number, std::nullopt);
  say("@" + std::to_string(number) + " " + std::string(line) + "\n");
  deadline_ = Wall::now() + timeout_;
  flush();
  return number;
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

void Manipulator::tell_budget() {
  if (state_ == State::active || state_ == State::restarting) say(manager_.budget().line() + "\n");
}

std::size_t Manipulator::queued() const { return input_ ? input_->pending() : 0; }

void Manipulator::flush() {
  if (!input_) return;
  input_->flush();
  // the end of its input is a second way to say quit
  if (quitting_ && input_->pending() == 0) input_.reset();
}

}  // namespace manager
