#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace channel {
class Loop;
}

namespace manager {

/// The prompt on a terminal: line editing with history across sessions and completion from the live world. What is
/// typed leaves through a pipe, so that it is read like any other stream. One in a program.
class Prompt {
 public:
  /// What may stand where the word `index` of a line stands, given the line so far; sorted or not.
  using Complete =
      std::function<std::vector<std::string>(const std::string& line, std::size_t start, const std::string& word)>;

  Prompt(channel::Loop& loop, Complete complete);
  /// Gives the terminal back as it was and keeps the history.
  ~Prompt();
  Prompt(const Prompt&) = delete;
  Prompt& operator=(const Prompt&) = delete;

  /// The end of the pipe that the lines come out of. Ours to give once.
  int reader();
  /// Shows the prompt and takes keys; until a line was entered.
  void show();
  /// Takes the prompt off the screen, so that something else can be printed; show() brings the typed text back.
  void hide();
  bool visible() const;
  /// Drops what was typed (Ctrl-C).
  void cancel();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace manager
