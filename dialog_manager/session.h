#pragma once

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dialog_manager/channel/loop.h"
#include "dialog_manager/command.h"

namespace manager {

/// A text that is being read: a script, a -c command, or a live stream.
struct Input {
  std::string name;    ///< as it stands in error messages
  std::string folder;  ///< where `source` looks beside it
  std::string text;    ///< of a script
  std::size_t at = 0;
  int line = 0;  ///< of the line read last
  objdb::Scope scope;
  std::string tag;       ///< of the `source` command that this text answers
  bool answers = false;  ///< it is the text of a `source` command of a framed conversation
  std::string where;     ///< FILE:LINE to blame, when it is not the text's own name and line
  std::unique_ptr<channel::Reader> live;
  bool put_off = false;  ///< a command of `at`, `every`, `when`
  bool fifo = false;     ///< writers come and go: the end of one is not the end of all
};

/// One conversation: lines in, replies out, in order. It waits while a command of its own takes time, and goes on to
/// the next line when that has ended. Errors stop it, unless it keeps going.
class Session : public Source {
 public:
  /// How replies look: body and errors for people, or framed lines for programs. Who speaks beside a framed
  /// conversation is answered with events on it ("event answer NAME LINE"), so that his answers are nobody else's; his
  /// errors are those for people.
  enum class Style { people, framed, beside };

  Session(std::string session_name, Style style, channel::Writer& out, channel::Writer& errors);
  /// Lines are at most this long, with their newline: 64 KiB, or PIPE_BUF on a FIFO, where longer ones may be torn.
  void limit_lines(std::size_t longest) { longest_line_ = longest; }
  /// One of several who share the answers' way: it is not listened to from half of what the main conversation may leave
  /// unread, so that it never stops that one.
  void speak_beside() { unread_limit_ /= 2; }
  /// Answers and events wait that nobody reads.
  bool behind() const { return out_.pending() > unread_limit_ || errors_.pending() > unread_limit_; }

  /// Reads this after everything that stands in the queue.
  void enqueue(Input input) { queue_.push_back(std::move(input)); }
  /// Reads this now, before going on.
  void interpose(Input input) { stack_.push_back(std::move(input)); }

  /// Takes up to `budget` lines, or until something must be waited for. False: nothing was done.
  bool step(Manager& manager, int budget);
  /// Nothing is left to read, nothing is waited for.
  bool finished() const { return queue_.empty() && stack_.empty() && !operation_; }
  /// A stream ended, or an error stopped it.
  bool failed() const { return failed_; }
  void keep_going(bool keep) { keep_going_ = keep; }
  /// Drops everything that is still to be read.
  void stop();
  /// Drops the scripts that are being read, or wait before the live stream, back to that.
  void leave_texts();

  /// Reads a single command in its turn; errors in it are told to stand at `where` (FILE:LINE).
  void enqueue_command(std::string text, std::string where, const objdb::Scope& scope);

  /// Waits for this before it reads on.
  void await(std::unique_ptr<Operation> operation, std::string where) {
    operation_ = std::move(operation);
    where_ = std::move(where);
  }
  Operation* operation() const { return operation_.get(); }
  /// Ends the operation that is under way with this.
  void end_operation(Manager& manager, const objdb::Status& status);
  /// A line for whoever listens, never inside a reply.
  void event(std::string_view text);

  /// How many texts are being read, one within the other.
  std::size_t depth() const { return stack_.size(); }
  const Input* input() const { return stack_.empty() ? nullptr : &stack_.back(); }
  /// Verbs may be shortened here while unambiguous.
  bool abbreviates() const { return abbreviates_; }
  void abbreviate(bool abbreviates) { abbreviates_ = abbreviates; }
  /// Ready for the next line: nothing runs, nothing is left of a script.
  bool idle() const {
    return !operation_ && queue_.empty() && stack_.size() == 1 && stack_.back().live &&
           !stack_.back().live->lines().has_line();
  }
  /// The line so far ended in a backslash: the next one goes on with it.
  bool within_line() const { return joining_; }
  /// Drops a line that was to go on.
  void drop_line() { joining_ = false; }
  Style style() const { return style_; }
  channel::Writer& out() { return out_; }
  channel::Writer& errors() { return errors_; }

 private:
  // a line with the places where continuation lines were joined to it
  struct Line {
    std::string_view text;
    int number = 0;
    std::vector<std::pair<std::size_t, int>> joints;  // offset in text, line number from there on
  };
  enum class Got { line, none, end };

  Got next_line(Manager& manager, Line& line);
  Got next_live(Manager& manager, Input& input, std::string_view& text);
  Got next_of_script(Manager& manager, Input& input, std::string_view& text);
  void run_line(Manager& manager, const Line& line, std::string where, objdb::Scope scope);
  void close_input(Manager& manager);
  void finish_reply(Manager& manager, const objdb::Status& status);
  void report(Manager& manager, const objdb::Error& error);
  void fail(Manager& manager);
  void answer_source(const Input& input);
  bool in_source_command() const;

  Style style_;
  channel::Writer& out_;
  channel::Writer& errors_;
  std::deque<Input> queue_;
  std::vector<Input> stack_;
  std::unique_ptr<Operation> operation_;
  std::string kept_line_, kept_prefix_;  // for the journal, when the operation has ended well
  bool abbreviates_ = false;
  std::size_t longest_line_ = 65536;
  unsigned lines_ = 0;  // that were read
  std::size_t unread_limit_ = 2 << 20;
  std::uint64_t missed_ = 0;  // events that were not told
  bool failed_ = false;
  bool keep_going_ = false;
  std::optional<objdb::Error> source_error_;  // the first one in the text of a framed `source` command

  // the command that is under way or was last
  objdb::LineWords words_;
  std::string joined_;
  bool joining_ = false;  // joined_ waits for the rest of its line
  std::string body_;
  std::string tag_;
  int verb_column_ = 1;
  std::string where_;  // place of the line, when it is not the input's
  Line line_;
};

}  // namespace manager
