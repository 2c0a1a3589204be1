#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dialog_manager/briefing.h"
#include "dialog_manager/channel/loop.h"
#include "dialog_manager/channel/process.h"
#include "dialog_manager/command.h"
#include "dialog_manager/declaration.h"
#include "dialog_manager/repetition.h"
#include "dialog_manager/told_log.h"

namespace manager {

/// A program on the other end of two pipes, as the manager sees it: its life, what it is asked and what it answers.
/// When it dies it is started again, told the same lines, and nobody notices.
class Manipulator : public Source, public objdb::Gate {
 public:
  enum class State { starting, handshaking, ready, active, restarting, ended, failed };
  using Policy = Declaration::Policy;
  using Verb = Declaration::Verb;

  Manipulator(Manager& manager, std::string program_name, std::string program, std::vector<std::string> argv,
              std::string serving);
  ~Manipulator() override;

  /// Starts the process and says hello. Errors: unknown, io, limit.
  objdb::Status launch();
  /// Asks it to end; ended() tells when it has.
  void quit();
  /// Ends it at once.
  void kill();

  State state() const { return state_; }
  std::string_view state_name() const;
  /// Why it failed.
  const objdb::Error& failure() const { return failure_; }
  bool alive() const { return process_.pid > 0; }
  pid_t pid() const { return process_.pid; }

  const Declaration& declared() const { return declared_; }
  const std::vector<Verb>& verbs() const { return declared_.verbs(); }
  /// Is the object at this path its to serve?
  bool serves_path(std::string_view path) const { return briefing_.serves_path(path); }
  double rate() const { return declared_.rate(); }
  objdb::Status may_write(const objdb::Object& object, int field) override;
  objdb::Status may_make(const objdb::Object& object) override;

  // -- a tick
  /// Is it to take part in this tick, given its own rate?
  bool due(std::uint64_t tick, double manager_rate) const;
  /// Tells what changed, then the tick.
  void send_tick(std::uint64_t tick, double time, double step);
  /// Does it owe an answer to a tick or a checkpoint?
  bool answering() const { return awaited_.has_value() || writing_down_; }
  /// Carries out what it said in this tick.
  void apply_answer();
  /// Drops what it said and no longer waits.
  void abandon_tick();

  // -- checkpoints
  /// Is it time that it writes down its state, before this tick?
  bool wants_checkpoint(std::uint64_t tick, double manager_rate) const;
  /// It shall write it down before the next tick in which it takes part.
  void want_checkpoint() { checkpoint_wanted_ = true; }
  void ask_checkpoint();
  /// Carries out what it wrote, when it was all good; what it was told before need not be told again then.
  void apply_checkpoint();
  /// The tick before which the last one was written, 0 for none.
  std::uint64_t checkpoint_tick() const { return checkpoint_tick_; }
  /// Bytes that a restart would tell it.
  std::size_t log_bytes() const { return log_.bytes(); }

  // -- arrays in shared memory
  /// The numbers that it announced as this sequence of a field; said and read already. Error unknown.
  struct Filled {
    std::string target;  // PATH.FIELD
    std::uint64_t sequence = 0;
    std::shared_ptr<ArrayMemory> memory;
    std::vector<double> numbers;
  };
  objdb::Result<Filled> take_filled(std::string_view target, std::uint64_t sequence);

  // -- a life that is made again from a journal: it is told everything at its end, and says it all again
  void spoke_before();
  void asked_before(std::uint64_t number, std::string_view line);
  void checkpoint_before(bool ended);
  void catch_up();

  // -- its verbs
  /// Forwards a line; the reply arrives under the number returned.
  std::uint64_t ask(std::string_view line);
  struct Reply {
    std::string body;
    objdb::Status status;
  };
  std::optional<Reply> take_reply(std::uint64_t number);

  /// Takes what arrived, and notices death. False: nothing happened.
  bool step();
  /// Ends it when it owes something for too long.
  void check_deadline();
  std::optional<channel::Clock::time_point> deadline() const;
  /// Tells what fidelity the scene wants.
  void tell_budget();
  /// The schema grew.
  void schema_changed() { briefing_.schema_changed(); }
  void flush();

  int restarts() const { return restarts_; }
  int stage = 0;
  double last_ms() const { return last_ms_; }
  std::size_t queued() const;
  /// Commands that wait for its reply.
  std::size_t asked() const;
  /// How long it owes what it owes, s; 0: nothing.
  double waiting() const;
  std::uint64_t refused() const { return refused_; }
  /// What was started, under whatever name.
  const std::string& program() const { return program_; }
  /// The command that started it.
  std::string command;

 private:
  // life
  void hello();
  void died(const std::string& how);
  void end_by_force(const std::string& how);
  std::string how_it_ended();
  void restart();
  void give_up(objdb::Error error);
  void close_process();
  void pass_errors_on();

  // what it says
  void receive(std::string_view line);
  void declaration(std::string_view line);
  objdb::Status declare(objdb::Words words, std::string_view line);
  void became_ready();
  void done(std::string_view line);
  void reply_line(std::string_view line);
  void keep_for_later(std::string_view line);
  void said(std::string_view line);
  void refuse(const objdb::Error& error);
  bool writes_down(std::string_view line);

  // arrays
  bool fill(std::string_view line);
  objdb::Status read_filled(std::string_view line);
  void note_long(std::string_view line);
  void grant();

  // what it is told
  void tell_changes();
  void tell_again();
  void tell(const Tale& tale);
  void tell_to_act(std::string_view line);
  void say(std::string_view text);
  void forget_the_past();
  bool owes() const;
  void set_deadline();

  Manager& manager_;
  std::string program_;
  std::vector<std::string> argv_;
  std::string hello_;
  State state_ = State::starting;
  objdb::Error failure_{objdb::ErrorKind::gone, {}, 0};

  channel::Process process_;
  std::unique_ptr<channel::Reader> output_, errors_;
  std::unique_ptr<channel::Writer> input_;
  std::unique_ptr<channel::ExitWatch> exit_;
  bool exited_ = false;
  bool quitting_ = false;

  Declaration declared_, declaring_;  // as it stands, and as a life that begins is saying it
  Briefing briefing_;
  ToldLog log_;
  Repetition repetition_;
  bool resumed_ = false;
  bool written_before_ = false;  // the journal says what it wrote down
  bool budget_told_ = false;

  std::optional<std::uint64_t> awaited_;  // the tick it owes
  bool writing_down_ = false;             // it owes its state
  bool answered_ = false;
  std::string answer_;
  std::uint64_t last_tick_ = 0;  // the last tick it was told
  std::string tick_line_;        // how
  std::uint64_t next_request_ = 1;
  std::vector<std::pair<std::uint64_t, std::optional<Reply>>> requests_;
  std::string reply_body_;

  struct Granted {  // memory that this life of it may fill
    std::shared_ptr<ArrayMemory> memory;
    std::size_t wanted = 0;
    std::uint64_t sequence = 0;
  };
  std::map<std::string, Granted, std::less<>> granted_;  // by PATH.FIELD
  std::set<std::string, std::less<>> long_sets_;         // long arrays that it said as text
  std::deque<Filled> filled_;

  std::uint64_t checkpoint_tick_ = 0, first_tick_ = 0;
  bool checkpoint_wanted_ = false;
  int lost_checkpoints_ = 0;  // in a row, lives that ended in one

  std::optional<channel::Clock::time_point> deadline_;
  channel::Clock::time_point asked_at_{};
  std::deque<channel::Clock::time_point> starts_;
  std::optional<channel::Clock::time_point> restart_at_;
  int restarts_ = 0;
  int strikes_ = 0;  // deaths since it last finished a tick
  int refused_in_row_ = 0;
  std::uint64_t refused_ = 0;
  double last_ms_ = 0;
  objdb::LineWords words_;
};

}  // namespace manager
