#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "objdb/result.h"
#include "objdb/statement.h"
#include "objdb/text.h"

namespace manager {

class Manager;
class Session;

/// Who speaks: a person, a script, a file, a program. `gate` limits what it may write; null: anything.
struct Source {
  std::uint16_t id = 0;
  std::string name;
  objdb::Gate* gate = nullptr;
};

/// Something a command waits for. Asked again after everything that happens; never blocks.
class Operation {
 public:
  virtual ~Operation() = default;
  /// The end of the command, or nothing yet. May append to the reply's body.
  virtual std::optional<objdb::Status> poll(Manager& manager, std::string& out) = 0;
  /// Does it need simulated time to go on?
  virtual bool wants_tick(const Manager&) const { return false; }
  /// Does it go on though time is paused?
  virtual bool steps() const { return false; }
  /// How much of it is done, from 0 to 1, when that is known.
  virtual std::optional<double> share(const Manager&) const { return std::nullopt; }
  /// When poll() is to be asked at the latest, though nothing happened.
  virtual std::optional<std::chrono::steady_clock::time_point> deadline() const { return std::nullopt; }
};

/// How a command ended: at once, well or with an error, or not yet.
struct Outcome {
  objdb::Status status;
  std::unique_ptr<Operation> operation;
  bool kept = false;  ///< the line belongs into the journal when the operation has ended well

  Outcome() = default;
  Outcome(objdb::Status ended) : status(std::move(ended)) {}
  Outcome(objdb::Error error) : status(std::move(error)) {}
  template <class T>
  Outcome(std::unique_ptr<T> waits) : operation(std::move(waits)) {}
};

/// One command as it was said.
struct Call {
  Manager& manager;
  Source& source;
  Session* session;           ///< null when a program speaks
  const objdb::Scope& scope;  ///< of a script read `under` a place
  const objdb::Word& verb;
  objdb::Words words;     ///< after the verb
  std::string_view line;  ///< the whole line
  std::string& out;       ///< body of the reply, lines with their newlines
  std::string kept = {};  ///< what the journal keeps in the place of the line, "" for the line itself

  /// The line from word `index` on: a command within a command.
  std::string_view rest(std::size_t index) const;
  /// Error at a word of the call; index -1 is the verb.
  objdb::Error error(int index, objdb::ErrorKind kind, std::string sentence) const;
};

/// What a command does to the world, which decides where it may stand and whether it is remembered.
enum class Effect {
  look,     ///< nothing
  change,   ///< changes the world: an undo step, part of the journal
  control,  ///< steers the manager
  time,     ///< makes time pass or waits: not for programs and scheduled commands
};

/// A verb of the manager, as a value: parser, help, completion and reference come from it.
struct Command {
  std::string_view name;
  std::string_view syntax;  ///< after the name
  std::string_view doc;     ///< one sentence; more lines may follow
  Effect effect;
  std::size_t least, most;  ///< number of words
  Outcome (*run)(Call& call);
};

constexpr std::size_t any_number = static_cast<std::size_t>(-1);

/// Every verb of the manager, by file name of dialog_manager/commands.
std::span<const Command* const> commands();
/// Null when there is none.
const Command* find_command(std::string_view name);

}  // namespace manager
