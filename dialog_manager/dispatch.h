#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "dialog_manager/command.h"
#include "dialog_manager/manipulator.h"

namespace manager {

/// From a line to what it does: finds its verb among the manager's and the programs', checks who may say it and when,
/// carries it out, and has it kept. What failed has changed nothing.
class Dispatch {
 public:
  explicit Dispatch(Manager& manager) : manager_(manager) {}

  Outcome execute(Source& source, Session* session, const objdb::LineWords& words, std::string_view line,
                  const objdb::Scope& scope, std::string& out);
  /// Forwards a line to a program, and waits for its reply; `said` is how it was said, for the columns of errors.
  std::unique_ptr<Operation> ask(Manipulator& manipulator, std::string_view line, const Call* said = nullptr);
  /// Who says the next changes, by this line.
  void speak_as(const Source& source, std::string_view line);
  /// Tells this session every accepted line, with who said it; null: nobody.
  void monitor_for(Session* session) { monitored_ = session; }
  /// This session is told nothing more.
  void forget(const Session& session) {
    if (monitored_ == &session) monitored_ = nullptr;
  }

 private:
  const Command* command_for(const objdb::Word& verb, const Session* session) const;
  objdb::Status may_say(const Call& call, const Command& command) const;
  Outcome steer(Call& call, const Command& command, bool kept);
  Outcome change(Call& call, const Command& command, bool kept);
  Outcome check_only(Call& call, const Command& command);
  Outcome say_to_program(Call& call);
  Outcome forward(Call& call, Manipulator& manipulator, const Manipulator::Verb& verb);
  Manipulator& shard_for(const Call& call, Manipulator& manipulator, const Manipulator::Verb& verb) const;
  void monitor(const Source& source, std::string_view line);

  Manager& manager_;
  Session* monitored_ = nullptr;
};

}  // namespace manager
