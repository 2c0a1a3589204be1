#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dialog_manager/channel/loop.h"
#include "dialog_manager/clock.h"
#include "dialog_manager/command.h"
#include "dialog_manager/journal.h"
#include "dialog_manager/line_log.h"
#include "dialog_manager/manipulator.h"
#include "dialog_manager/prompt.h"
#include "dialog_manager/schedule.h"
#include "dialog_manager/session.h"
#include "dialog_manager/shared_arrays.h"
#include "dialog_manager/trace.h"
#include "objdb/database.h"

namespace manager {

/// How the program was started.
struct Options {
  struct Text {
    std::string name;
    std::string text;
    bool file = false;
  };
  std::vector<Text> texts;   ///< scripts and -c commands, in order
  bool interactive = false;  ///< a prompt (after the texts)
  bool terminal = false;     ///< the prompt is on a terminal
  bool read_input = false;   ///< commands from standard input
  bool framed = false;
  bool keep_going = false;
  std::uint64_t seed = 0;
  std::string journal;  ///< file to keep every accepted line in
  std::string resume;   ///< journal to go on with
  double pace = 0;
  bool check = false;          ///< read and check everything, change nothing
  std::string program_folder;  ///< where dialog_manager lies: programs are looked for beside it
};

/// The dialog manager: one world, everyone who speaks to it, the programs that move it, and time.
/// One thread; between two ticks lines are carried out, during a tick the programs answer.
class Manager {
 public:
  explicit Manager(Options options);
  ~Manager();
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// Until everything is read and done. The exit status.
  int run();

  objdb::Database world;
  Clock clock;
  Schedule schedule;
  LineLog lines;
  SharedArrays arrays;

  // -- commands
  /// Carries out one line: finds its verb, checks, runs. What failed has changed nothing.
  Outcome execute(Source& source, Session* session, const objdb::LineWords& words, std::string_view line,
                  const objdb::Scope& scope, std::string& out);
  /// The name of a source by its number.
  std::string source_name(std::uint16_t id) const;
  const Options& options() const { return options_; }
  /// "PATH,WORD": a program that finds WORD in PATH can open what this process has open; "": there is none.
  const std::string& probe() const { return probe_.text(); }

  // -- transactions and undo
  objdb::Status begin(Session& session);
  objdb::Status commit(Session& session);
  objdb::Status roll_back(Session& session);
  objdb::Status undo(std::size_t count);
  objdb::Status redo(std::size_t count);
  /// Another session's transaction is open.
  bool busy_for(const Session& session) const { return transaction_ != nullptr && transaction_ != &session; }
  bool in_transaction() const { return transaction_ != nullptr; }

  // -- memory
  /// Keeps every accepted line from now on, after the world as it stands. Errors: io, busy.
  objdb::Status begin_journal(const std::string& path, Journal::Sync sync);
  void end_journal() {
    if (keep(true)) journal_.reset();
  }
  Journal* journal() { return journal_.get(); }
  /// Sends answers on, after the journal has what they acknowledge. A journal that cannot be written any more ends the
  /// manager, and the answers that wait are not given.
  void acknowledge();
  /// Keeps a line that was accepted.
  void journal(const Source& source, std::string_view prefix, std::string_view line);
  /// Keeps that a program begins (ends) to write down its state.
  void journal_checkpoint(std::string_view program, bool ended);
  bool replaying() const { return replaying_; }
  void replaying(bool replaying) { replaying_ = replaying; }
  /// The lines that the journal says next belong to a tick that it has not closed yet.
  void replaying_tick(bool inside) { replaying_tick_ = inside; }
  /// Is what is said now said in a tick, of which other programs' delayed reads see nothing yet?
  bool in_tick() const { return tick_in_flight() || replaying_tick_; }
  /// Who says the next changes, by this line.
  void speak_as(const Source& source, std::string_view line);
  void replay_tick();
  /// A journal says what is said next, and when: what was put off is not carried out a second time, and what a tick
  /// did can be taken back.
  void follow_journal(bool follow) { following_ = follow; }
  bool following_journal() const { return following_; }
  /// What programs that start from now on draw their chances from.
  void seed(std::uint64_t seed) { options_.seed = seed; }
  /// Forwards a line to a program, and waits for its reply.
  std::unique_ptr<Operation> ask(Manipulator& manipulator, std::string_view line);
  /// The journal has been carried out; programs that were started on the way take up where they were.
  void end_replay(bool live);
  /// Goes back to a time of the journal. Errors: io, range.
  Outcome rewind(double time);
  Session* main_session() { return main_.get(); }
  int stages() const { return stages_; }

  // -- more speakers, and who looks on
  /// Reads commands from a FIFO, made with mode 0600 when it is not there. Errors: exists, io, limit.
  objdb::Status listen(const std::string& path);
  objdb::Status unlisten(const std::string& path);
  std::vector<std::string> sources() const;
  /// Tells this session every accepted line, with who said it; null: nobody.
  void monitor_for(Session* session) { monitored_ = session; }
  objdb::Status watch(Session& session, std::string pattern, objdb::Scope scope);
  void unwatch(const Session& session);
  void add_trace(std::unique_ptr<Trace> trace) { traces_.push_back(std::move(trace)); }
  /// False: no trace to that file.
  bool end_trace(const std::string& path) {
    return std::erase_if(traces_, [&](const auto& trace) { return trace->path() == path; }) > 0;
  }
  struct Counters {
    std::uint64_t lines = 0, ticks = 0;
  } counters;

  // -- fidelity
  /// What the scene wants: at most this error (m, rad), or this time a tick (s); nothing when neither is said.
  struct Budget {
    enum class Of { nothing, error, time } of = Of::nothing;
    double value = 0;
    std::string line() const;
  };
  const Budget& budget() const { return budget_; }
  void set_budget(const Budget& budget);

  // -- time
  bool tick_in_flight() const { return stage_ >= 0; }
  /// Time flows by itself, between run commands too.
  void run_free(bool free) { free_ = free; }
  bool paused() const { return paused_by_.has_value(); }
  /// Is time paused by this source, or by a command kept for later: by nobody who could let it go on while the
  /// source waits?
  bool paused_for_good(std::uint16_t source) const;
  void pause(const Source& source);
  void go_on();
  /// Makes everyone who waits for time fail with this.
  void break_tick(const objdb::Error& error);

  // -- programs
  /// When a program is asked to write down its state: after so many ticks, or when it was told so many bytes since the
  /// last time; 0: never for this reason.
  struct Checkpoints {
    std::uint64_t ticks = 60;
    std::size_t bytes = 16u << 20;
  } checkpoints;
  objdb::Result<Manipulator*> start(const std::string& program, const std::string& as,
                                    const std::vector<std::string>& launcher, const std::string& serving,
                                    const std::vector<std::string>& arguments);
  Manipulator* find_manipulator(std::string_view name) const;
  const std::vector<std::unique_ptr<Manipulator>>& manipulators() const { return manipulators_; }
  void drop(Manipulator& manipulator);
  /// Orders the programs: a writer stands before its readers. Error when they form a circle.
  objdb::Status arrange_stages();
  void schema_changed();

  // -- sessions
  void session_failed(Session& session);
  void stream_ended(Session& session);
  /// The FIFO from its next writer on. Errors: io (gone, no FIFO, not ours), limit.
  objdb::Result<Input> fifo_input(const std::string& path);
  void event(std::string_view text);
  channel::Writer& errors() { return errors_; }
  channel::Loop& loop() { return loop_; }
  /// Ctrl-C: drops the line that is typed, or ends what the main conversation waits for.
  void interrupt();
  std::uint16_t add_source(std::string name);
  bool quitting() const { return quitting_; }
  void quit() { quitting_ = true; }
  void fail() { exit_status_ = 1; }

  /// 64 bits over the declarations and the world.
  std::uint64_t hash() { return world.hash(); }

 private:
  const Command* abbreviated(std::string_view verb) const;
  Outcome check_only(Call& call, const Command& command);
  Outcome forward(Call& call, Manipulator& manipulator, const Manipulator::Verb& verb);
  void remember(std::uint64_t mark);
  bool step();
  bool step_sessions();
  bool step_tick();
  std::vector<Manipulator*> by_name() const;
  bool begin_checkpoints();
  bool step_checkpoints();
  void begin_tick();
  void next_stage();
  void finish_tick();
  bool wants_tick() const;
  bool all_read() const;
  std::optional<channel::Clock::time_point> next_deadline() const;
  void flush();
  void monitor(const Source& source, std::string_view line);
  void tell_watchers();
  void tell_watched(const objdb::Object& object, int field);
  bool open_journals();
  void close_tick_record();
  bool keep(bool tick_ended);
  void end_programs();
  void open_streams();

  Options options_;
  ArrayProbe probe_;
  channel::Loop loop_;
  channel::Writer out_, errors_;
  std::vector<std::string> source_names_;
  std::unique_ptr<Prompt> prompt_;
  std::unique_ptr<Session> main_;
  std::unique_ptr<Session> scheduled_;
  std::vector<std::unique_ptr<Session>> speakers_, ending_;
  std::vector<std::string> made_fifos_;
  std::vector<std::unique_ptr<Manipulator>> manipulators_;
  struct Watch {
    Session* session;
    std::string pattern;
    objdb::Scope scope;
  };
  std::vector<Watch> watches_;
  std::optional<objdb::Database::FeedId> watch_feed_;
  std::set<std::pair<objdb::ObjectId, int>> unwatched_;  // changes that nobody read in time: told at their newest
  std::vector<std::unique_ptr<Trace>> traces_;
  Session* monitored_ = nullptr;
  std::unique_ptr<Journal> journal_;
  bool journal_lost_ = false;  // it could not be written: this is the end
  Budget budget_;
  bool replaying_ = false, replaying_tick_ = false, following_ = false;
  std::optional<double> rewinding_;  // to note in the journal when it is done
  std::size_t resume_good_ = 0;
  std::uint64_t resume_check_ = 0;

  bool checkpointing_ = false;  // programs write down their state, before a tick
  int stage_ = -1;
  int stages_ = 0;
  bool free_ = false;
  std::optional<std::uint16_t> paused_by_;  // id of the source
  Session* transaction_ = nullptr;
  std::uint64_t transaction_mark_ = 0;
  std::deque<std::uint64_t> undo_marks_;
  std::vector<std::vector<objdb::Database::Change>> redo_;
  bool quitting_ = false;
  int exit_status_ = 0;
  int signal_ = 0;
};

}  // namespace manager
