#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "dialog_manager/channel/loop.h"
#include "dialog_manager/channel/process.h"
#include "dialog_manager/command.h"

namespace manager {

/// A program on the other end of two pipes, as the manager sees it: what it declared, what it has been told, what it
/// owes an answer to. When it dies it is started again, told the same lines, and nobody notices.
class Manipulator : public Source, public objdb::Gate {
 public:
  enum class State { starting, handshaking, ready, active, restarting, ended, failed };
  /// What happens to the world when the program cannot be kept alive.
  enum class Policy { stop, hold, skip };

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

  // -- what it declared
  struct Access {
    std::string type, field;  ///< field empty: all of the type
    bool delayed = false;
  };
  struct Verb {
    std::string name, syntax, doc;
  };
  const std::vector<Access>& reads() const { return reads_; }
  const std::vector<Access>& writes() const { return writes_; }
  const std::vector<Verb>& verbs() const { return verbs_; }
  /// Does it read (write) this field, by declaration?
  bool reads(const objdb::Field& field, bool* delayed = nullptr) const;
  bool writes(const objdb::Field& field) const;
  /// Does it name this very field, as TYPE.FIELD, in its reads?
  bool reads_by_name(const objdb::Field& field, bool* delayed) const;
  /// Is the object at this path its to serve?
  bool serves_path(std::string_view path) const { return serving_.empty() || objdb::matches(serving_, path); }
  double rate() const { return rate_; }
  objdb::Status may_write(const objdb::Object& object, int field) override;
  objdb::Status may_make(const objdb::Object& object) override;

  // -- a tick
  /// Is it to take part in this tick, given its own rate?
  bool due(std::uint64_t tick, double manager_rate) const;
  /// Tells what changed, then the tick.
  void send_tick(std::uint64_t tick, double time, double step);
  bool answering() const { return awaited_.has_value(); }
  // -- a life that is made again from a journal: it is told everything at its end, and says it all again
  void spoke_before() { ++spoken_; }
  void asked_before(std::uint64_t number, std::string_view line);
  void catch_up();

  /// Carries out what it said in this tick.
  void apply_answer();
  /// Drops what it said and no longer waits.
  void abandon_tick();

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
  void schema_changed();
  void flush();

  int restarts() const { return restarts_; }
  int stage = 0;
  double last_ms() const { return last_ms_; }
  std::size_t queued() const;
  /// What was started, under whatever name.
  const std::string& program() const { return program_; }
  /// The command that started it.
  std::string command;

 private:
  struct Interest {                   // per type: which of its fields are told
    std::vector<signed char> fields;  // 0 no, 1 yes, 2 delayed
    bool any = false;
  };

  void say(std::string_view line);
  void log(std::string_view line);
  void hello();
  void receive(std::string_view line);
  void declaration(std::string_view line);
  objdb::Status declare(objdb::Words words, std::string_view line);
  void became_ready();
  void tell_again();
  void reply_line(std::string_view line);
  void said(std::string_view line);
  void refuse(const objdb::Error& error);
  void died(const std::string& how);
  void restart();
  void give_up(objdb::Error error);
  void close_process();

  const Interest& interest(const objdb::Type& type);
  bool serves(const objdb::Object& object) const;
  void tell_world();
  void tell_changes();
  void meet_type(const objdb::Type& type);
  void meet_targets(const objdb::Field& field, const objdb::Value& value);
  void meet(const objdb::Object& object);
  void introduce();
  bool told(objdb::ObjectId id) const { return id < told_.size() && told_[id]; }
  bool declared_here(const objdb::Type& type) const;
  void pass_errors_on();

  Manager& manager_;
  std::string program_;
  std::vector<std::string> argv_;
  std::string serving_;
  State state_ = State::starting;
  objdb::Error failure_{objdb::ErrorKind::gone, {}, 0};

  channel::Process process_;
  std::unique_ptr<channel::Reader> output_, errors_;
  std::unique_ptr<channel::Writer> input_;
  std::unique_ptr<channel::ExitWatch> exit_;
  bool exited_ = false;

  std::vector<Access> reads_, writes_;
  std::vector<Verb> verbs_;
  std::vector<const objdb::Type*> own_types_;
  double rate_ = 0;  // 0: every tick
  std::chrono::milliseconds timeout_{2000};
  Policy policy_ = Policy::stop;
  bool quitting_ = false;

  objdb::Database::FeedId feed_ = 0;
  bool subscribed_ = false;
  std::vector<bool> told_;
  std::vector<bool> told_types_;
  std::vector<const objdb::Object*> fresh_;                     // met, not yet told
  std::vector<std::pair<objdb::ObjectId, int>> deferred_;       // delayed reads of this tick
  std::unordered_map<const objdb::Type*, Interest> interests_;  // whose values stay where they are as it grows
  std::string outgoing_;

  std::string log_;  // every line told, for a restart
  bool log_whole_ = true;
  std::optional<std::uint64_t> awaited_;    // the tick it owes
  std::uint64_t last_tick_ = 0;             // the last tick it was told
  std::uint64_t previous_tick_ = 0;         // the one before
  std::size_t spoken_ = 0;                  // lines carried out since its last `done`, outside of ticks
  std::size_t to_drop_ = 0;                 // after a restart: how many of them it still repeats
  std::optional<std::uint64_t> replaying_;  // after a restart: what it says up to the end of this tick was said before
  bool answered_ = false;
  std::string answer_;
  std::uint64_t next_request_ = 1;
  std::vector<std::pair<std::uint64_t, std::optional<Reply>>> requests_;
  std::string reply_body_;

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
