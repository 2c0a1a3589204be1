#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace manager {

/// Tells what a program says anew from what it said, and had carried out, in an earlier life. A program that is told
/// everything again says everything again: up to the last thing that it finished (a tick or a command), and the lines
/// that it had said since then on a command that it had not finished.
class Repetition {
 public:
  /// A command was sent to it.
  void asked() { ++asked_; }
  /// A line that it said between ticks was carried out.
  void spoke() {
    if (asked_ > 0) ++spoken_;
  }
  /// It finished a tick ("done 17"), a command ("@7 ...").
  void finished(std::string_view line) {
    last_ = key(line);
    spoken_ = 0;
    asked_ = line.starts_with('@') && asked_ > 0 ? asked_ - 1 : 0;
  }
  /// What it said so far it will not be told to say again.
  void forget() {
    last_.clear();
    spoken_ = 0;
    asked_ = 0;
  }

  /// It is told everything again.
  void begin() {
    until_ = last_;
    to_drop_ = spoken_;
  }
  /// Is this line one that was carried out before? Each line must be asked for once, in order.
  bool heard_before(std::string_view line) {
    if (!until_.empty()) {
      if (key(line) == until_) until_.clear();
      return true;
    }
    if (to_drop_ == 0 || line.starts_with("  ") || line.starts_with('@')) return false;
    --to_drop_;
    return true;
  }
  bool under_way() const { return !until_.empty() || to_drop_ > 0; }

 private:
  // "done 17" is known by all of it, "@7 ok" by its number
  static std::string_view key(std::string_view line) {
    return line.starts_with('@') ? line.substr(0, line.find(' ')) : line;
  }

  std::string last_;  // what it finished last
  std::size_t spoken_ = 0, asked_ = 0;
  std::string until_;        // it repeats itself up to this line,
  std::size_t to_drop_ = 0;  // and then this many lines more
};

}  // namespace manager
