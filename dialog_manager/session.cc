#include "dialog_manager/session.h"

#include <algorithm>

#include "dialog_manager/manager.h"

namespace manager {
namespace {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Status;

// "@tag" at the beginning of a line that cannot be split any further
std::string tag_of(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  if (line.empty() || line[0] != '@') return {};
  return std::string(line.substr(1, line.find_first_of(" \t\r") - 1));
}

// an odd number of backslashes at the end continues the line
bool continues(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::size_t count = 0;
  while (count < line.size() && line[line.size() - 1 - count] == '\\') ++count;
  return count % 2 == 1;
}

std::string_view without_backslash(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line.substr(0, line.size() - 1);
}

// what follows the line that was read last
std::string_view rest(const Input& input) {
  return input.live ? input.live->lines().rest() : std::string_view(input.text).substr(input.at);
}

}  // namespace

Session::Session(std::string session_name, Style style, channel::Writer& out, channel::Writer& errors)
    : style_(style), out_(out), errors_(errors) {
  name = std::move(session_name);
}

void Session::stop() {
  queue_.clear();
  stack_.clear();
}

bool Session::step(Manager& manager, int budget) {
  bool did = false;
  while (budget-- > 0 && !manager.quitting()) {
    if (operation_) {
      const std::optional<Status> ended = operation_->poll(manager, body_);
      if (!ended) return did;
      end_operation(manager, *ended);
      did = true;
      continue;
    }
    if (manager.history.busy_for(*this)) return did;
    // who does not read his answers is not listened to
    if (behind()) {
      manager.acknowledge();
      if (behind()) return did;
    }
    const Got got = next_line(manager, line_);
    if (got == Got::end && finished()) return did;
    if (got == Got::none) return did;
    did = true;
    if (got != Got::line) continue;
    if (++lines_ % objdb::lines_looked_ahead == 0) look_ahead(manager.world, rest(stack_.back()));
    run_line(manager, line_, stack_.back().where, stack_.back().scope);
    // a tick that is under way is not to be disturbed
    if (!manager.resting()) return did;
  }
  return did;
}

Session::Got Session::next_line(Manager& manager, Line& line) {
  if (stack_.empty()) {
    if (queue_.empty()) return Got::end;
    stack_.push_back(std::move(queue_.front()));
    queue_.pop_front();
  }
  if (!joining_) line.joints.clear();
  while (true) {
    Input& input = stack_.back();
    std::string_view text;
    const Got got = input.live ? next_live(manager, input, text) : next_of_script(manager, input, text);
    if (got == Got::none) return got;
    if (got == Got::end) {
      // an error has dropped the input
      if (stack_.empty()) return got;
      if (!joining_) {
        close_input(manager);
        return got;
      }
      joining_ = false;
      line.text = joined_;
      return Got::line;
    }
    // lines of a program stand alone; those of a script that it has read do not
    const bool goes_on = (style_ != Style::framed || !input.live) && continues(text);
    if (!joining_) {
      line.number = input.line;
      line.text = text;
      if (!goes_on) return Got::line;
      joined_.clear();
      joining_ = true;
    } else {
      line.joints.emplace_back(joined_.size(), input.line);
    }
    // what is too long already does not grow
    if (joined_.size() <= longest_line_) joined_ += goes_on ? without_backslash(text) : text;
    if (goes_on) continue;
    joining_ = false;
    line.text = joined_;
    return Got::line;
  }
}

Session::Got Session::next_of_script(Manager&, Input& input, std::string_view& text) {
  if (input.at >= input.text.size()) return Got::end;
  const std::size_t newline = input.text.find('\n', input.at);
  ++input.line;
  if (newline == std::string::npos) {
    text = std::string_view(input.text).substr(input.at);
    input.at = input.text.size();
    if (!input.folder.empty())
      errors_.write(input.name + ":" + std::to_string(input.line) + ":" + std::to_string(text.size()) +
                    ": warning the last line has no newline\n");
    return Got::line;
  }
  text = std::string_view(input.text).substr(input.at, newline - input.at);
  input.at = newline + 1;
  return Got::line;
}

Session::Got Session::next_live(Manager& manager, Input& input, std::string_view& text) {
  using Next = channel::LineBuffer::Next;
  while (true) {
    switch (input.live->lines().next(text)) {
      case Next::line: ++input.line; return Got::line;
      case Next::too_long:
        ++input.line;
        where_ = input.name + ":" + std::to_string(input.line);
        line_.joints.clear();
        tag_ = tag_of(text);
        joining_ = false;
        finish_reply(manager,
                     Error{ErrorKind::limit,
                           "the line is longer than " + std::to_string(longest_line_) + " bytes and was skipped", 1});
        if (stack_.empty()) return Got::end;
        break;
      case Next::half:
        ++input.line;
        where_ = input.name + ":" + std::to_string(input.line);
        line_.joints.clear();
        tag_.clear();
        joining_ = false;
        finish_reply(manager, Error{ErrorKind::syntax, "the stream ended within a line, which was not run", 1});
        if (stack_.empty()) return Got::end;
        break;
      case Next::end: return Got::end;
      case Next::none:
        input.live->want();
        if (input.live->lines().has_line() || input.live->at_end()) break;
        return Got::none;
    }
  }
}

void Session::close_input(Manager& manager) {
  Input closed = std::move(stack_.back());
  stack_.pop_back();
  if (closed.live || (closed.put_off && stack_.empty())) manager.stream_ended(*this);
  if (closed.fifo) {
    objdb::Result<Input> next = manager.speakers.fifo_input(closed.name);
    if (next)
      enqueue(std::move(*next));
    else
      manager.event("event gone " + closed.name + " " + next.error().sentence);
  }
  if (closed.answers) answer_source(closed);
}

// a copy of the scope: the line may read a script, and the stack that the scope stands in moves
// NOLINTNEXTLINE(performance-unnecessary-value-param)
void Session::run_line(Manager& manager, const Line& line, std::string where, objdb::Scope scope) {
  body_.clear();
  tag_.clear();
  where_ = std::move(where);
  verb_column_ = 1;
  const std::size_t depth = stack_.size();
  if (Status split = words_.split(line.text); !split) {
    tag_ = tag_of(line.text);
    finish_reply(manager, split);
    return;
  }
  if (words_.empty()) return;
  tag_ = words_.tag();
  verb_column_ = words_.words()[0].column;
  if (line.text.size() + 1 > longest_line_) {
    finish_reply(manager,
                 Error{ErrorKind::limit,
                       "the line is longer than " + std::to_string(longest_line_) + " bytes and was skipped", 1});
    return;
  }
  Outcome outcome = manager.dispatch.execute(*this, this, words_, line.text, scope, body_);
  if (outcome.operation) {
    operation_ = std::move(outcome.operation);
    kept_line_ = outcome.kept ? line.text : std::string_view();
    kept_prefix_ = scope.prefix;
    return;
  }
  // `source` of a framed conversation is answered when its text has been read
  if (stack_.size() > depth && style_ == Style::framed) {
    stack_.back().answers = !in_source_command();
    if (stack_.back().answers) stack_.back().tag = tag_;
    return;
  }
  finish_reply(manager, outcome.status);
}

void Session::enqueue_command(std::string text, std::string where, const objdb::Scope& scope) {
  Input input;
  input.name = name;
  input.text = std::move(text);
  input.scope = scope;
  input.where = std::move(where);
  input.put_off = true;
  enqueue(std::move(input));
}

void Session::end_operation(Manager& manager, const Status& status) {
  operation_.reset();
  if (status && !kept_line_.empty()) manager.recorder.add(*this, kept_prefix_, kept_line_);
  kept_line_.clear();
  finish_reply(manager, status);
}

void Session::finish_reply(Manager& manager, const Status& status) {
  if (style_ == Style::people) {
    out_.buffer() += body_;
  } else {
    const std::string head = style_ == Style::framed ? "  " : "event answer " + name + " ";
    std::string_view rest = body_;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size() - 1);
      out_.buffer().append(head).append(rest.substr(0, end + 1));
      rest.remove_prefix(end + 1);
    }
    if (style_ == Style::framed && !tag_.empty() && status) out_.buffer().append("@").append(tag_).append(" ok\n");
  }
  body_.clear();
  if (out_.pending() > 64 * 1024) manager.acknowledge();
  if (!status) {
    report(manager, status.error());
    fail(manager);
  }
}

void Session::report(Manager& manager, const Error& error) {
  // the column counts from the start of the line that the word stands on
  // what has no place of its own is blamed on the verb
  const int whole = error.column > 0 ? error.column : verb_column_;
  int number = line_.number, column = whole;
  for (const auto& [offset, line] : line_.joints)
    if (static_cast<std::size_t>(whole) > offset) {
      number = line;
      column = whole - static_cast<int>(offset);
    }
  std::string where = where_;
  const bool typed = where.empty() && error.column > 0 && !stack_.empty() && stack_.back().live != nullptr;
  if (where.empty()) where = (stack_.empty() ? name : stack_.back().name) + ":" + std::to_string(number);
  where_.clear();
  if (style_ == Style::framed) {
    // an error within the text of a `source` command is that command's
    if (in_source_command()) {
      if (!source_error_)
        source_error_ = Error{error.kind, where + ":" + std::to_string(column) + ": " + error.sentence, 1};
      return;
    }
    std::string& out = out_.buffer();
    if (!tag_.empty()) out.append("@").append(tag_).append(" ");
    out.append("error ").append(name_of(error.kind)).append(" ").append(std::to_string(whole));
    out.append(" ").append(error.sentence).append("\n");
    return;
  }
  // what was answered before stands before the error, also where both go to one terminal
  if (typed && out_.pending() == 0) errors_.write(manager.caret(column));
  manager.acknowledge();
  errors_.write(where + ":" + std::to_string(column) + ": error " + std::string(name_of(error.kind)) + " " +
                error.sentence + "\n");
  where_.clear();
}

void Session::fail(Manager& manager) {
  failed_ = true;
  // the text of a framed `source` command ends at its first error, and so does the command
  while (!keep_going_ && in_source_command()) {
    const Input ended = std::move(stack_.back());
    stack_.pop_back();
    if (ended.answers) answer_source(ended);
  }
  manager.session_failed(*this);
}

bool Session::in_source_command() const {
  return std::any_of(stack_.begin(), stack_.end(), [](const Input& input) { return input.answers; });
}

void Session::answer_source(const Input& input) {
  tag_ = input.tag;
  body_.clear();
  line_.joints.clear();
  if (!source_error_) {
    if (!tag_.empty()) out_.buffer().append("@").append(tag_).append(" ok\n");
    return;
  }
  const Error error = std::move(*source_error_);
  source_error_.reset();
  std::string& out = out_.buffer();
  if (!tag_.empty()) out.append("@").append(tag_).append(" ");
  out.append("error ").append(name_of(error.kind)).append(" 1 ").append(error.sentence).append("\n");
}

void Session::leave_texts() {
  while (!stack_.empty() && !stack_.back().live) stack_.pop_back();
  const auto live =
      std::find_if(queue_.begin(), queue_.end(), [](const Input& input) { return input.live != nullptr; });
  if (live != queue_.end()) queue_.erase(queue_.begin(), live);
}

void Session::event(std::string_view text) {
  // twice as much room as for answers, so that the end of a program is told when watched values fill the way
  if (out_.pending() > 2 * unread_limit_ || errors_.pending() > 2 * unread_limit_) {
    ++missed_;
    return;
  }
  if (missed_ > 0) {
    const std::string missed = "event missed " + std::to_string(missed_);
    missed_ = 0;
    event(missed);
  }
  if (style_ != Style::people)
    out_.buffer().append(text).append("\n");
  else
    errors_.write(std::string(text) + "\n");
}

}  // namespace manager
