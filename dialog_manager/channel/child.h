#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dialog_manager/channel/loop.h"
#include "dialog_manager/channel/process.h"

namespace channel {

/// A child process with its lines: what it hears, what it says, what it complains of. Its end is the end of its words;
/// what is left of it and of its children then goes with it.
class Child {
 public:
  /// Errors as those of spawn().
  static objdb::Result<std::unique_ptr<Child>> start(Loop& loop, const std::vector<std::string>& argv,
                                                     std::size_t longest_line);
  /// Ends it at once, with its process group.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return process_.pid; }

  /// What it hears; null after close_input().
  Writer* input() const { return input_.get(); }
  void close_input() { input_.reset(); }

  /// What it says. A half line at its end is nothing that it said.
  enum class Next { line, too_long, none, end };
  Next next(std::string_view& line);
  /// What it complains of; asks for more when there is nothing.
  Next next_complaint(std::string_view& line);

  /// Ends it, with its process group, and waits for it: "exit status 3" or "killed 9" when it had ended by itself,
  /// "closed output" when it only said no more.
  std::string end();

 private:
  Child(Loop& loop, Process process, std::size_t longest_line);

  Process process_;
  Reader output_, errors_;
  std::unique_ptr<Writer> input_;
  bool exited_ = false;
  ExitWatch exit_;
};

}  // namespace channel
