// The life of a program: started, watched, ended, started again.

#include <csignal>
#include <utility>

#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;
using Wall = channel::Clock;

constexpr std::size_t longest_line = 65536;
constexpr auto handshake_limit = std::chrono::seconds(10);
// that nobody has read, of all programs
constexpr std::size_t unread_errors = 1u << 20;

}  // namespace

Status Manipulator::launch() {
  Result<std::unique_ptr<channel::Child>> child = channel::Child::start(manager_.loop(), argv_, longest_line);
  if (!child) return child.error();
  child_ = std::move(*child);
  life_.take(Life::Event::launched);
  restart_policy_.started(Wall::now());
  deadline_ = Wall::now() + handshake_limit;
  arrays_.begin_life();
  input()->write(handshake_.begin());
  input()->flush();
  return {};
}

void Manipulator::became_ready() {
  deadline_.reset();
  life_.take(Life::Event::declared);
  declared_ = std::move(handshake_.declared());
  // who is asked to end hears nothing more
  if (quitting_) return;
  if (!begun()) {
    begin_story();
    return;
  }
  life_.take(Life::Event::briefed);
  const bool afresh = story_.lost();
  tell_again();
  manager_.event("event restarted " + name + (afresh ? " afresh" : ""));
}

void Manipulator::begin_story() {
  if (Status arranged = manager_.programs.arrange(); !arranged) {
    give_up(arranged.error());
    return;
  }
  manager_.programs.schema_changed();
  tell(story_.begin(id));
  life_.take(Life::Event::briefed);
  if (manager_.budget().of != Budget::Of::nothing) tell_budget();
}

// -- the end of a life

void Manipulator::quit() {
  if (quitting_ && alive()) return;
  quitting_ = true;
  restart_at_.reset();
  if (!alive()) {
    life_.take(Life::Event::ended);
    return;
  }
  input()->write("quit\n");
  flush();
}

void Manipulator::lose_child() {
  pass_errors_on();
  child_.reset();
  shown_.end_life();
}

void Manipulator::end_by_force(const std::string& how) {
  lose_child();
  died(how);
}

void Manipulator::died(const std::string& how) {
  deadline_.reset();
  if (quitting_) {
    life_.take(Life::Event::ended);
    return;
  }
  manager_.event("event gone " + name + " " + how);
  if (!begun()) {
    give_up({ErrorKind::gone, name + " ended with " + how + " before it was ready", 0});
    return;
  }
  note_lost_checkpoint(how);
  using Verdict = RestartPolicy::Verdict;
  const auto [verdict, when] = restart_policy_.died(Wall::now(), how == "garbage");
  const bool skips = declared_.policy() == Policy::skip;
  const bool forgotten = story_.lost() && declared_.policy() == Policy::stop;
  if (forgotten || verdict == Verdict::too_often || (verdict == Verdict::struck_out && !skips)) {
    give_up(reason(how, verdict, forgotten));
    return;
  }
  if (verdict == Verdict::struck_out) skip(how);
  life_.take(Life::Event::lost);
  restart_at_ = when;
}

Error Manipulator::reason(const std::string& how, RestartPolicy::Verdict verdict, bool forgotten) const {
  const int strikes = restart_policy_.strikes();
  std::string sentence = name + " ended with " + how + " at tick " + std::to_string(checkpoints_.last_tick());
  if (forgotten)
    sentence += ", and what it was told without a checkpoint is more than is kept";
  else if (verdict == RestartPolicy::Verdict::struck_out)
    sentence += ", " + std::to_string(strikes) + " times in a row";
  else
    sentence += how == "garbage" ? ", twice in a row" : ", and was started more than 5 times in 10 s";
  return {how == "timeout" ? ErrorKind::timeout : ErrorKind::gone, std::move(sentence), 0};
}

// what it dies of is left out: its next life is told the world as it stands then
void Manipulator::skip(const std::string& how) {
  const bool of_tick = answer_.tick().has_value();
  abandon_tick();
  requests_.fail(reason(how, RestartPolicy::Verdict::struck_out, false));
  story_.lose();
  restart_policy_.finished();
  manager_.event("event skipped " + name +
                 (of_tick ? " tick " + std::to_string(checkpoints_.last_tick()) : std::string(" what it was asked")));
}

void Manipulator::note_lost_checkpoint(const std::string& how) {
  if (!answer_.state_owed() || !checkpoints_.died()) return;
  answer_.state_no_longer();
  manager_.event("event checkpoint " + name + " is asked for no longer: it ended with " + how + " when it was asked");
}

void Manipulator::restart() {
  restart_at_.reset();
  ++restarts_;
  if (Status launched = launch(); !launched) give_up(launched.error());
}

void Manipulator::give_up(Error error) {
  lose_child();
  life_.take(Life::Event::given_up);
  failure_ = std::move(error);
  deadline_.reset();
  restart_at_.reset();
  abandon_tick();
  requests_.fail(failure_);
  manager_.event("event failed " + name);
  if (!begun()) return;
  // changes are not kept for who will not hear of them
  story_.briefing().end();
  holds_time_ = declared_.policy() == Policy::stop;
  if (holds_time_) manager_.break_time(failure_);
}

// -- watched

bool Manipulator::step() {
  bool did = false;
  if (restart_at_ && Wall::now() >= *restart_at_) {
    restart();
    did = true;
  }
  pass_errors_on();
  std::string_view line;
  // what it says may be its end
  while (alive()) {
    switch (child_->next(line)) {
      case channel::Child::Next::line: receive(line); break;
      case channel::Child::Next::too_long:
        refuse(
            {ErrorKind::limit, "a line is longer than " + std::to_string(longest_line) + " bytes and was skipped", 1});
        break;
      case channel::Child::Next::none: return did;
      case channel::Child::Next::end: {
        // the end of its words is its end
        const std::string how = child_->end();
        lose_child();
        died(how);
        break;
      }
    }
    did = true;
  }
  return did;
}

void Manipulator::pass_errors_on() {
  if (!alive()) return;
  std::string_view line;
  // when nobody reads our errors, the program waits
  while (manager_.errors().pending() < unread_errors) {
    switch (child_->next_complaint(line)) {
      case channel::Child::Next::line: manager_.errors().write(name + ": " + std::string(line) + "\n"); break;
      case channel::Child::Next::too_long: manager_.errors().write(name + ": (a line too long to show)\n"); break;
      case channel::Child::Next::none:
      case channel::Child::Next::end: return;
    }
  }
}

void Manipulator::set_deadline() {
  if (state() != State::active) return;
  if (owes())
    deadline_ = Wall::now() + declared_.timeout();
  else
    deadline_.reset();
}

void Manipulator::check_deadline() {
  if (!deadline_ || Wall::now() < *deadline_ || !alive()) return;
  if (begun())
    end_by_force("timeout");
  else
    give_up({ErrorKind::timeout, name + " did not say ready in 10 s", 0});
}

double Manipulator::waiting() const {
  return owes() ? std::chrono::duration<double>(Wall::now() - asked_at_).count() : 0;
}

}  // namespace manager
