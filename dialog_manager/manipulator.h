#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dialog_manager/answer.h"
#include "dialog_manager/channel/child.h"
#include "dialog_manager/checkpoint_plan.h"
#include "dialog_manager/command.h"
#include "dialog_manager/granted_arrays.h"
#include "dialog_manager/handshake.h"
#include "dialog_manager/life.h"
#include "dialog_manager/refusals.h"
#include "dialog_manager/repetition.h"
#include "dialog_manager/requests.h"
#include "dialog_manager/restart_policy.h"
#include "dialog_manager/rights.h"
#include "dialog_manager/shown_arrays.h"
#include "dialog_manager/story.h"

namespace manager {

/// A program on the other end of two pipes, as the manager sees it: its life, what it is asked and what it answers.
/// When it dies it is started again, told the same lines, and nobody notices.
///
///   child --lines--> handshake, until it is ready; then --> answer (of a tick), requests (of verbs), dispatch
///   world --changes--> story --tale--> child              deadline, refusals, end of the child --> restart policy
class Manipulator : public Source {
 public:
  using State = Life::State;
  using Policy = Declaration::Policy;
  using Verb = Declaration::Verb;

  Manipulator(Manager& manager, std::string program_name, std::string program, std::vector<std::string> argv,
              std::string serving);
  ~Manipulator();
  Manipulator(const Manipulator&) = delete;
  Manipulator& operator=(const Manipulator&) = delete;

  // -- its life (supervision.cc)
  /// Starts the process and says hello. Errors: unknown, io, limit.
  objdb::Status launch();
  /// Asks it to end; alive() tells when it has.
  void quit();
  State state() const { return life_.state(); }
  std::string_view state_name() const { return life_.name(); }
  /// It ended or failed, and will not take part any more.
  bool over() const { return life_.over(); }
  /// It failed, and no time shall pass without it, until a person says so.
  bool holds_time() const { return life_.is(State::failed) && holds_time_; }
  /// Why it failed.
  const objdb::Error& failure() const { return failure_; }
  bool alive() const { return child_ != nullptr; }
  pid_t pid() const { return child_ ? child_->pid() : -1; }
  int restarts() const { return restarts_; }
  /// Takes what arrived, and notices death. False: nothing happened.
  bool step();
  /// Ends it when it owes something for too long.
  void check_deadline();
  std::optional<channel::Clock::time_point> deadline() const { return restart_at_ ? restart_at_ : deadline_; }
  /// How long it owes what it owes, s; 0: nothing.
  double waiting() const;

  // -- what it declared
  const Declaration& declared() const { return declared_; }
  const std::vector<Verb>& verbs() const { return declared_.verbs(); }
  double rate() const { return declared_.rate(); }
  /// Is the object at this path its to serve?
  bool serves_path(std::string_view path) const { return story_.briefing().serves_path(path); }
  /// It was ready once, and follows the world.
  bool begun() const { return story_.begun(); }
  Briefing& briefing() { return story_.briefing(); }
  /// The schema grew.
  void schema_changed() { story_.briefing().schema_changed(); }
  /// What was started, under whatever name.
  const std::string& program() const { return program_; }
  /// The command that started it.
  std::string command;

  // -- a tick
  int stage = 0;
  /// Is it to take part in this tick, given its own rate?
  bool due(std::uint64_t tick, double manager_rate) const;
  /// Tells what changed, then the tick.
  void send_tick(std::uint64_t tick, double time, double step);
  /// Does it owe an answer to a tick or a checkpoint?
  bool answering() const { return answer_.owed(); }
  /// Carries out what it said in this tick.
  void apply_answer();
  /// Drops what it said and no longer waits.
  void abandon_tick() { answer_.abandon(); }
  double last_ms() const { return last_ms_; }

  // -- checkpoints
  /// Is it time that it writes down its state, before this tick?
  bool wants_checkpoint(std::uint64_t tick, double manager_rate) const;
  /// It shall write it down before the next tick in which it takes part.
  void want_checkpoint() { checkpoints_.want(); }
  /// Is there a state that it could write down now?
  bool can_checkpoint() const;
  void ask_checkpoint();
  /// Carries out what it wrote, when it was all good; what it was told before need not be told again then.
  void apply_checkpoint();
  /// The tick before which the last one was written, 0 for none.
  std::uint64_t checkpoint_tick() const { return checkpoints_.tick(); }
  /// Bytes that a restart would tell it.
  std::size_t log_bytes() const { return story_.bytes(); }

  // -- a life that is made again from a journal: it is told everything at its end, and says it all again
  void spoke_before();
  void asked_before(std::uint64_t number, std::string_view line);
  void checkpoint_before(bool ended);
  void catch_up();

  // -- its verbs
  /// Forwards a line; the reply arrives under the number returned.
  std::uint64_t ask(std::string_view line);
  /// The reply, once; nothing while it is waited for.
  std::optional<Requests::Reply> take_reply(std::uint64_t number);
  /// Commands that wait for its reply.
  std::size_t asked() const { return requests_.waiting(); }

  GrantedArrays& arrays() { return arrays_; }
  /// Tells what fidelity the scene wants.
  void tell_budget();
  void flush();
  /// Bytes that wait for it to read.
  std::size_t queued() const;
  /// Lines of it that were refused.
  std::uint64_t refused() const { return refusals_.all(); }

 private:
  // life
  void died(const std::string& how);
  void end_by_force(const std::string& how);
  void restart();
  void give_up(objdb::Error error);
  void lose_child();
  void note_lost_checkpoint(const std::string& how);
  objdb::Error reason(const std::string& how, RestartPolicy::Verdict verdict, bool forgotten) const;
  void skip(const std::string& how);
  void pass_errors_on();
  void became_ready();
  void begin_story();
  bool owes() const { return answering() || asked() > 0; }
  void set_deadline();

  // what it says
  void receive(std::string_view line);
  void declare(std::string_view line);
  void done(std::string_view line);
  void reply_line(std::string_view line);
  bool fill(std::string_view line);
  void keep_for_later(std::string_view line);
  void said(std::string_view line);
  void answer_question(std::string_view body);
  void refuse(const objdb::Error& error);
  bool writes_down(std::string_view line);

  // what it is told
  channel::Writer* input() const { return child_ ? child_->input() : nullptr; }
  void tell_changes();
  void tell_again();
  void tell(const Tale& tale);
  void tell_to_act(std::string_view line);
  SayFrame frames_said();
  void heard_from();
  void say(std::string_view text);

  Manager& manager_;
  std::string program_;
  std::vector<std::string> argv_;

  Life life_;
  RestartPolicy restart_policy_;
  std::unique_ptr<channel::Child> child_;
  bool quitting_ = false, holds_time_ = false;
  int restarts_ = 0;
  objdb::Error failure_{objdb::ErrorKind::gone, {}, 0};
  std::optional<channel::Clock::time_point> deadline_, restart_at_;

  Declaration declared_;
  Handshake handshake_;
  Rights rights_;
  Story story_;
  ShownArrays shown_;
  Repetition repetition_;
  bool resumed_ = false;
  bool written_before_ = false;  // the journal says what it wrote down

  Answer answer_;
  std::string tick_line_;  // the last tick as it was told
  CheckpointPlan checkpoints_;
  Requests requests_;
  GrantedArrays arrays_;
  Refusals refusals_;
  channel::Clock::time_point asked_at_{};
  double last_ms_ = 0;
  objdb::LineWords words_;
};

}  // namespace manager
