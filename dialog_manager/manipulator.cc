#include "dialog_manager/manipulator.h"

#include <algorithm>
#include <utility>

#include "dialog_manager/manager.h"
#include "dialog_manager/own_rate.h"

namespace manager {
namespace {

using namespace objdb;
using Wall = channel::Clock;

// of our errors: refusals are not told to a person who does not read them
constexpr std::size_t unread_refusals = 4u << 20;

}  // namespace

Manipulator::Manipulator(Manager& manager, std::string program_name, std::string program, std::vector<std::string> argv,
                         std::string serving)
    : manager_(manager),
      program_(std::move(program)),
      argv_(std::move(argv)),
      handshake_(manager, *this),
      rights_(manager, *this),
      story_(manager.world, declared_, std::move(serving)),
      shown_(manager.world),
      arrays_(manager.world) {
  name = std::move(program_name);
  gate = &rights_;
}

Manipulator::~Manipulator() { lose_child(); }

// -- what it says

void Manipulator::receive(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (state() == State::handshaking) {
    declare(line);
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
    requests_.body(line.substr(2));
  else if (answering())
    keep_for_later(line);
  else
    said(line);
}

void Manipulator::declare(std::string_view line) {
  const Result<bool> ready = handshake_.take(line);
  if (!ready)
    give_up(ready.error());
  else if (*ready)
    became_ready();
}

void Manipulator::done(std::string_view line) {
  const bool of_state = answer_.state_owed() && line.size() == 4;
  if (Status ended = answer_.done(line); !ended) {
    refuse(ended.error());
    return;
  }
  if (of_state) {
    checkpoints_.answered();
  } else {
    restart_policy_.finished();
    repetition_.finished(line);
    last_ms_ = std::chrono::duration<double, std::milli>(Wall::now() - asked_at_).count();
  }
  refusals_.accepted();
  heard_from();
}

// what it says in a tick counts when the tick's turn comes
void Manipulator::keep_for_later(std::string_view line) {
  // what is no command at all is refused at once, so that garbage does not grow until the end of the tick
  const std::string_view verb = line.substr(0, line.find_first_of(" \t"));
  if (!line.empty() && line[0] != '#' && find_command(verb) == nullptr)
    refuse({ErrorKind::unknown, "no verb " + quote(verb.substr(0, 60)), 1});
  else if (Status kept = answer_.add(line); !kept)
    refuse(kept.error());
}

void Manipulator::said(std::string_view line) {
  if (Status split = words_.split(line); !split) {
    refuse(split.error());
    return;
  }
  if (words_.empty()) return;
  if (!manager_.tick_in_flight()) repetition_.spoke();
  std::string body;
  const Outcome outcome = manager_.dispatch.execute(*this, nullptr, words_, line, {}, body);
  if (!outcome.status) {
    refuse(outcome.status.error());
    return;
  }
  refusals_.accepted();
  // what it said as a long text it could say shorter
  if (declared_.shares_arrays() && line.size() >= 2 * long_array && line.starts_with("set "))
    arrays_.note_long(words_.words()[1]);
  answer_question(body);
}

// a program may ask too; its answers look like everyone's
void Manipulator::answer_question(std::string_view body) {
  if (input() == nullptr) return;
  std::string& out = input()->buffer();
  while (!body.empty()) {
    const std::size_t end = std::min(body.find('\n'), body.size() - 1);
    out.append("  ").append(body.substr(0, end + 1));
    body.remove_prefix(end + 1);
  }
  if (!words_.tag().empty()) out.append("@").append(words_.tag()).append(" ok\n");
}

void Manipulator::refuse(const Error& error) {
  refusals_.refused(Wall::now());
  const std::string text = "error " + std::string(name_of(error.kind)) + " " +
                           std::to_string(std::max(error.column, 1)) + " " + error.sentence;
  if (input() != nullptr) {
    input()->write(text + "\n");
    input()->flush();
  }
  if (refusals_.worth_telling() && manager_.errors().pending() < unread_refusals)
    manager_.errors().write(name + ": refused: " + text.substr(6) + "\n");
  if (!refusals_.too_many() || !alive()) return;
  refusals_.forgive();
  end_by_force("garbage");
}

// the numbers of an array in shared memory are taken as soon as they are announced. False: it was refused.
bool Manipulator::fill(std::string_view line) {
  Status filled = words_.split(line);
  if (filled) filled = arrays_.fill(words_.words(), name, [this](const std::string& event) { manager_.event(event); });
  if (!filled) refuse(filled.error());
  return filled.ok();
}

// -- what it is told

void Manipulator::say(std::string_view text) {
  // while it is restarted the log is all it needs
  if (input() != nullptr && state() == State::active && !manager_.playback.replaying()) input()->write(text);
}

void Manipulator::tell(const Tale& tale) {
  if (input() != nullptr && state() != State::handshaking && !manager_.playback.replaying())
    tale.append_to(input()->buffer(), frames_said());
}

SayFrame Manipulator::frames_said() {
  return [this](std::string& out, const Frame& frame) { shown_.say(out, frame, declared_.shares_arrays()); };
}

// who owes nothing any more has read all that it was told before it was asked
void Manipulator::heard_from() {
  set_deadline();
  if (!owes()) shown_.all_read();
}

void Manipulator::tell_to_act(std::string_view line) {
  story_.act(line);
  say(line);
}

void Manipulator::tell_changes() { tell(story_.changes(manager_.in_tick() ? manager_.clock.tick() + 1 : 0)); }

// everything it was told, once more; what it answers up to where it was has been carried out
void Manipulator::tell_again() {
  if (answering()) {
    answer_.start_over();
    arrays_.drop_filled();
  }
  requests_.drop_body();
  if (story_.lost()) {
    // it knows nothing yet of what these changes are about: they are in what it is told
    (void)story_.changes(0);
    repetition_.forget();
  }
  repetition_.begin();
  input()->write(story_.retell(answer_.tick() ? tick_line_ : std::string(), frames_said()));
  if (answer_.state_owed()) input()->write("checkpoint\n");
  input()->flush();
  set_deadline();
}

void Manipulator::tell_budget() {
  if (begun()) tell(story_.budget(manager_.budget().line()));
}

std::size_t Manipulator::queued() const { return input() != nullptr ? input()->pending() : 0; }

void Manipulator::flush() {
  if (input() == nullptr) return;
  input()->flush();
  // the end of its input is a second way to say quit
  if (quitting_ && input()->pending() == 0) child_->close_input();
}

// -- ticks

bool Manipulator::due(std::uint64_t tick, double manager_rate) const {
  if (over() || state() == State::starting || !begun()) return false;
  return OwnRate{rate()}.due(tick, manager_rate);
}

void Manipulator::send_tick(std::uint64_t tick, double time, double step) {
  tell_changes();
  const double own_step = OwnRate{rate()}.step(tick, checkpoints_.last_tick(), step);
  checkpoints_.ticked(tick);
  asked_at_ = Wall::now();
  if (manager_.playback.replaying()) {
    answer_.start_over();
    repetition_.finished("done " + std::to_string(tick));
  } else {
    answer_.expect_tick(tick);
  }
  tick_line_ = "tick " + std::to_string(tick) + " " + number(time) + " " + number(own_step) + "\n";
  tell_to_act(tick_line_);
  set_deadline();
  flush();
}

void Manipulator::apply_answer() {
  const std::optional<std::string> answer = answer_.take();
  if (!answer) return;
  for_each_line(*answer, [this](std::string_view line) { said(line); });
  arrays_.drop_filled();
  arrays_.grant([this](const std::string& line) { say(line); },
                [this](const std::string& event) { manager_.event(event); });
  flush();
}

// -- checkpoints

// one that is about to be started again is asked then
bool Manipulator::can_checkpoint() const {
  return declared_.checkpoints() && begun() && !over() && !checkpoints_.given_up();
}

bool Manipulator::wants_checkpoint(std::uint64_t tick, double manager_rate) const {
  if (!can_checkpoint() || state() != State::active || checkpoints_.last_tick() == 0 || !due(tick, manager_rate))
    return false;
  // a journal that is followed says when
  if (manager_.playback.following()) return checkpoints_.wanted();
  const Manager::Checkpoints& every = manager_.checkpoints;
  return checkpoints_.wanted() || (every.ticks > 0 && checkpoints_.since() >= every.ticks) ||
         (every.bytes > 0 && story_.since() >= every.bytes);
}

void Manipulator::ask_checkpoint() {
  tell_changes();
  checkpoints_.asked();
  answer_.expect_state();
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
  const std::optional<std::string> answer = answer_.take();
  if (!answer) return;
  const std::uint64_t refused = refusals_.all();
  std::string rest;
  manager_.recorder.add_checkpoint(name, false);
  // what a person did before can be taken back; that it was written down cannot
  manager_.world.assign_beneath(true);
  for_each_line(*answer, [&](std::string_view line) {
    if (writes_down(line))
      said(line);
    else
      rest.append(line).append("\n");
  });
  manager_.world.assign_beneath(false);
  checkpoints_.written();
  if (refused == refusals_.all()) {
    manager_.recorder.add_checkpoint(name, true);
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
  checkpoints_.written();
  story_.checkpoint();
  repetition_.forget();
}

void Manipulator::spoke_before() {
  if (!written_before_) repetition_.spoke();
}

void Manipulator::catch_up() {
  written_before_ = false;
  if (input() == nullptr || !begun()) return;
  resumed_ = true;
  tell_again();
}

void Manipulator::asked_before(std::uint64_t number, std::string_view line) {
  tell_changes();
  requests_.added_before(number);
  repetition_.asked();
  tell_to_act("@" + std::to_string(number) + " " + std::string(line) + "\n");
}

// -- its verbs

std::uint64_t Manipulator::ask(std::string_view line) {
  tell_changes();
  const std::uint64_t number = requests_.add();
  repetition_.asked();
  asked_at_ = Wall::now();
  tell_to_act("@" + std::to_string(number) + " " + std::string(line) + "\n");
  set_deadline();
  flush();
  return number;
}

void Manipulator::reply_line(std::string_view line) {
  if (requests_.close(line)) {
    repetition_.finished(line);
    heard_from();
    return;
  }
  // a second answer after a restart is nothing to complain about
  const std::optional<std::uint64_t> number = request_number(line);
  const bool again = restarts_ > 0 || resumed_;
  if (!again || !number || !requests_.known(*number))
    refuse({ErrorKind::unknown, "no command waits for " + std::string(line.substr(0, line.find(' '))), 1});
}

std::optional<Requests::Reply> Manipulator::take_reply(std::uint64_t number) {
  if (!requests_.has(number)) return Requests::Reply{{}, Error{ErrorKind::gone, name + " is gone", 0}};
  return requests_.take(number);
}

}  // namespace manager
