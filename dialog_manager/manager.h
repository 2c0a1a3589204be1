#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dialog_manager/array_memory.h"
#include "dialog_manager/budget.h"
#include "dialog_manager/channel/loop.h"
#include "dialog_manager/clock.h"
#include "dialog_manager/dispatch.h"
#include "dialog_manager/history.h"
#include "dialog_manager/line_log.h"
#include "dialog_manager/lockstep.h"
#include "dialog_manager/options.h"
#include "dialog_manager/playback.h"
#include "dialog_manager/programs.h"
#include "dialog_manager/progress.h"
#include "dialog_manager/prompt.h"
#include "dialog_manager/recorder.h"
#include "dialog_manager/schedule.h"
#include "dialog_manager/session.h"
#include "dialog_manager/speakers.h"
#include "dialog_manager/trace.h"
#include "dialog_manager/watches.h"
#include "objdb/database.h"

namespace manager {

/// The dialog manager: one world, everyone who speaks to it, the programs that move it, and time.
/// One thread; between two ticks lines are carried out, during a tick the programs answer.
///
///   main, scheduled, speakers --lines--> dispatch --> world --changes--> programs, watches, traces
///   lockstep: tick --> programs --answers, by name--> dispatch          dispatch, ticks --> recorder --> journal
class Manager {
  // what everyone waits in and speaks through: it outlives them
  channel::Loop loop_;
  channel::Writer out_, errors_;

 public:
  explicit Manager(Options options);
  ~Manager();
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// Until everything is read and done. The exit status.
  int run();

  /// How wide the terminal of the prompt is; 0 without a prompt.
  std::size_t columns() const;
  /// A line that points at byte `column` of what was typed last, when it stands right above; else nothing.
  std::string caret(int column) const;

  objdb::Database world;
  Clock clock;
  Schedule schedule;
  LineLog lines;
  History history{world};
  Dispatch dispatch{*this};
  Recorder recorder{*this};
  Playback playback{*this};
  Watches watches{world};
  Speakers speakers{*this};
  Programs programs{*this};

  /// 64 bits over the declarations and the world.
  std::uint64_t hash() { return world.hash(); }
  struct Counters {
    std::uint64_t lines = 0, ticks = 0;
  } counters;
  /// When a program is asked to write down its state: after so many ticks, or when it was told so many bytes since the
  /// last time; 0: never for this reason.
  struct Checkpoints {
    std::uint64_t ticks = 60;
    std::size_t bytes = 16u << 20;
  } checkpoints;

  const Options& options() const { return options_; }
  /// What programs that start from now on draw their chances from.
  void seed(std::uint64_t seed) { options_.seed = seed; }
  /// "PATH,WORD": a program that finds WORD in PATH can open what this process has open; "": there is none.
  const std::string& probe() const { return probe_.text(); }
  const Budget& budget() const { return budget_; }
  void set_budget(const Budget& budget);

  // -- time
  bool tick_in_flight() const { return lockstep_.in_flight(); }
  /// Is what is said now said in a tick, of which other programs' delayed reads see nothing yet?
  bool in_tick() const { return tick_in_flight() || playback.inside_tick(); }
  /// Time flows by itself, between run commands too.
  void run_free(bool free) { free_ = free; }
  bool paused() const { return paused_by_.has_value(); }
  /// Is time paused by this source, or by a command kept for later: by nobody who could let it go on while the
  /// source waits?
  bool paused_for_good(std::uint16_t source) const;
  void pause(const Source& source);
  void go_on();
  /// Neither a tick nor the writing down of states is under way: lines can be carried out.
  bool resting() const { return lockstep_.resting(); }
  /// Does no program hold time that failed? Else who waits for time is told so.
  bool may_tick();
  /// What a tick needs before it begins. False: there will be none.
  bool begin_tick();
  /// Every program has answered: time goes on, and who waits for it is served.
  void finish_tick();
  /// Makes everyone who waits for time fail with this, when the tick that is under way is over.
  void break_time(const objdb::Error& error);
  /// Has a program, or with null all of them, write down their state, so that the world has it; resting() tells when
  /// they have. Not within a transaction, which could take it back, and not while a journal says what they wrote.
  void write_down(const Manipulator* only);

  // -- who speaks, and who listens
  std::uint16_t add_source(std::string name);
  /// The name of a source by its number.
  std::string source_name(std::uint16_t id) const;
  std::vector<std::string> sources() const;
  Session* main_session() { return main_.get(); }
  /// Is it the one that says what was put off until later?
  bool is_scheduled(const Session& session) const { return &session == scheduled_.get(); }
  void session_failed(Session& session);
  void stream_ended(Session& session);
  void add_trace(std::unique_ptr<Trace> trace) { traces_.push_back(std::move(trace)); }
  /// False: no trace to that file.
  bool end_trace(const std::string& path) {
    return std::erase_if(traces_, [&](const auto& trace) { return trace->path() == path; }) > 0;
  }
  void event(std::string_view text) { main_->event(text); }
  channel::Writer& out() { return out_; }
  channel::Writer& errors() { return errors_; }
  channel::Loop& loop() { return loop_; }
  /// Sends answers on, after the journal has what they acknowledge. A journal that cannot be written any more ends the
  /// manager, and the answers that wait are not given.
  void acknowledge();
  void lose_answers();

  // -- the end
  /// Ctrl-C: drops the line that is typed, or ends what the main conversation waits for.
  void interrupt();
  bool quitting() const { return quitting_; }
  void quit() { quitting_ = true; }
  void fail() { exit_status_ = 1; }

 private:
  void open_texts();
  void open_input();
  bool open_journals();
  bool step();
  bool step_sessions();
  bool step_time();
  bool wants_tick() const;
  void end_waiting(const objdb::Error& error);
  bool all_read() const;
  std::optional<channel::Clock::time_point> next_deadline() const;
  void flush();
  void show_progress();
  int end();

  Options options_;
  ArrayProbe probe_;
  std::vector<std::string> source_names_;
  std::unique_ptr<Prompt> prompt_;
  Progress progress_{STDERR_FILENO};
  std::unique_ptr<Session> main_;
  std::unique_ptr<Session> scheduled_;
  std::vector<std::unique_ptr<Trace>> traces_;
  Budget budget_;
  Lockstep lockstep_{*this};
  bool free_ = false;
  std::optional<objdb::Error> broken_;      // time, at the end of this tick
  std::optional<std::uint16_t> paused_by_;  // id of the source
  bool quitting_ = false;
  int exit_status_ = 0;
  int signal_ = 0;
};

}  // namespace manager
