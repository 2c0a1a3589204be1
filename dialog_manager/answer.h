#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "objdb/result.h"

namespace manager {

/// What a program owes, a tick's answer or its state, and the lines that it has said of it so far. They count when the
/// turn of the program comes, all at once.
class Answer {
 public:
  void expect_tick(std::uint64_t tick);
  void expect_state();
  /// It need not answer after all: no longer ask for it, and drop what was said.
  void abandon();
  /// It is asked for its state no longer.
  void state_no_longer() { state_ = false; }
  /// Another life says it from the beginning.
  void start_over();

  std::optional<std::uint64_t> tick() const { return tick_; }  ///< that it owes
  bool state_owed() const { return state_; }
  bool owed() const { return tick_.has_value() || state_; }

  /// One line more. Error limit, when there are more than a tick can take.
  objdb::Status add(std::string_view line);
  /// "done 17", or "done" of its state. Error range: that is not what it owes.
  objdb::Status done(std::string_view line);
  /// What it said, when it said done; once.
  std::optional<std::string> take();

 private:
  std::optional<std::uint64_t> tick_;
  bool state_ = false;
  bool whole_ = false;
  std::string text_;
};

/// Calls with every line of a text in which each has its newline.
template <class Visit>
void for_each_line(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    visit(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
}

}  // namespace manager
