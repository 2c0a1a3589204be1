#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "dialog_manager/completion.h"

namespace channel {
class Loop;
}

namespace manager {

/// The prompt on a terminal: line editing with history across sessions and completion from the live world. What is
/// typed leaves through a pipe, so that it is read like any other stream. One in a program.
class Prompt {
 public:
  /// What may stand at the end of the line as it was typed up to the cursor.
  using Complete = std::function<Completion(const std::string& line)>;

  Prompt(channel::Loop& loop, Complete complete);
  /// Gives the terminal back as it was.
  ~Prompt();
  Prompt(const Prompt&) = delete;
  Prompt& operator=(const Prompt&) = delete;

  /// The end of the pipe that the lines come out of. Ours to give once.
  int reader();
  /// Shows the prompt and takes keys, until a line was entered; `continues` when the line before ended in a backslash.
  void show(bool continues);
  /// Takes the prompt off the screen, so that something else can be printed; show() brings the typed text back.
  void hide();
  bool visible() const;
  /// Drops what was typed (Ctrl-C).
  void cancel();
  /// The terminal has another size, or was somebody else's for a while: draws the prompt anew.
  void redraw();
  /// Columns from the edge of the screen to byte `column` (from 1) of the line entered last; nothing when it does not
  /// stand on one row of its own.
  std::optional<std::size_t> place(int column) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace manager
