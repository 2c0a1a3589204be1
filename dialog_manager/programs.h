#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dialog_manager/manipulator.h"

namespace manager {

/// The programs that move the world, in the order in which they were started.
class Programs {
 public:
  explicit Programs(Manager& manager) : manager_(manager) {}

  /// What `start` says.
  struct Start {
    std::string program, as;
    std::vector<std::string> launcher;
    std::string serving;
    std::vector<std::string> arguments;
  };
  /// Begins its life; ready it is later. Errors: syntax, exists, unknown, io, limit.
  objdb::Result<Manipulator*> start(Start what);
  /// Null when there is none of this name.
  Manipulator* find(std::string_view name) const;
  const std::vector<std::unique_ptr<Manipulator>>& all() const { return all_; }
  /// In the order of their names, in which their answers count.
  std::vector<Manipulator*> by_name() const;
  /// Forgets it: its fields are free for another writer.
  void drop(Manipulator& manipulator);

  /// Orders them: a writer stands before its readers. Error busy when they form a circle.
  objdb::Status arrange();
  int stages() const { return stages_; }
  void schema_changed();

  /// Takes what they said, ends who owes something for too long. False: nothing happened.
  bool step();
  std::optional<channel::Clock::time_point> deadline() const;
  void flush();

  /// Ends them at once.
  void kill_all();
  /// Asks them to end, in the reverse order of their start, and waits; who does not listen is ended.
  void end_all();

 private:
  objdb::Result<std::string> name_for(const Start& what) const;
  std::vector<std::string> command_line(const Start& what) const;

  Manager& manager_;
  std::vector<std::unique_ptr<Manipulator>> all_;
  int stages_ = 0;
};

}  // namespace manager
