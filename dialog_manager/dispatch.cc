#include "dialog_manager/dispatch.h"

#include <algorithm>
#include <iterator>

#include "dialog_manager/manager.h"
#include "dialog_manager/replay.h"

namespace manager {
namespace {

using namespace objdb;

// where a word stands in the line that a program is told, and in the line that was said; so many columns on they agree
struct Place {
  int told, said, alike;
};

// a forwarded command waits for its manipulator's answer
class Asked : public Operation {
 public:
  Asked(std::string program, std::uint64_t number, std::vector<Place> places)
      : program_(std::move(program)), number_(number), places_(std::move(places)) {}
  std::optional<Status> poll(Manager& manager, std::string& out) override {
    Manipulator* manipulator = manager.programs.find(program_);
    if (manipulator == nullptr) return Status(Error{ErrorKind::gone, program_ + " is gone", 0});
    std::optional<Requests::Reply> reply = manipulator->take_reply(number_);
    if (!reply) return std::nullopt;
    out += reply->body;
    if (reply->status) return reply->status;
    Error error = reply->status.error();
    error.column = column_said(error.column);
    return Status(std::move(error));
  }

 private:
  // the program counts in the line that it was told, behind a tag of its own
  int column_said(int column) const {
    column -= static_cast<int>(("@" + std::to_string(number_) + " ").size());
    const Place* place = nullptr;
    for (const Place& each : places_)
      if (each.told <= column) place = &each;
    if (place == nullptr) return 0;
    return place->said + std::min(column - place->told, place->alike);
  }

  std::string program_;
  std::uint64_t number_;
  std::vector<Place> places_;
};

Error unknown_verb(const Manager& manager, const Word& verb) {
  if (verb.quoted) return {ErrorKind::unknown, "no verb " + shown(verb.text) + ": a verb is a bare word", verb.column};
  std::vector<std::string_view> names;
  for (const Command* command : commands()) names.push_back(command->name);
  for (const auto& manipulator : manager.programs.all())
    for (const Manipulator::Verb& each : manipulator->verbs()) names.push_back(each.name);
  const std::string_view said = verb.text.substr(0, 60);
  // what it may be short for, else what it may be mistyped for
  std::string longer;
  for (const std::string_view name : names)
    if (name.starts_with(said)) longer += (longer.empty() ? ", did you mean " : ", ") + std::string(name);
  return {ErrorKind::unknown, "no verb " + quote(said) + (longer.empty() ? did_you_mean(said, names) : longer + "?"),
          verb.column};
}

// a program speaks about its part of the world. What a person does at its window comes over a FIFO of its own, and may
// stop time
bool is_for_programs(const Command& command) {
  static constexpr std::string_view steering[] = {"listen", "unlisten", "pause", "resume"};
  if (command.name == "type" || command.name == "field") return false;
  return command.effect != Effect::control ||
         std::find(std::begin(steering), std::end(steering), command.name) != std::end(steering);
}

const Command* abbreviated(std::string_view verb) {
  // the shortest that fits, when all others that fit only go on from it: lis is list, beside listen
  const Command* found = nullptr;
  for (const Command* command : commands())
    if (command->name.starts_with(verb) && (found == nullptr || command->name.size() < found->name.size()))
      found = command;
  if (found == nullptr) return nullptr;
  for (const Command* command : commands())
    if (command->name.starts_with(verb) && !command->name.starts_with(found->name)) return nullptr;
  return found;
}

// the line as a program reads it: paths of a script that is read under a place are said in full
std::string forwarded(const Call& call, const Manipulator::Verb& verb, const Database& world) {
  std::string line(verb.name);
  for (const Word& word : call.words) {
    line += ' ';
    const bool inner =
        !call.scope.prefix.empty() && !word.quoted && world.find(call.scope.resolve(word.text)) != nullptr;
    line += inner                               ? call.scope.resolve(word.text)
            : word.quoted && is_path(word.text) ? "\"" + std::string(word.text) + "\""
                                                : quote(word.text);
  }
  return line;
}

// its words are those that were said, in their order
std::vector<Place> places_of(const Call& call, std::string_view told) {
  std::vector<Place> out;
  LineWords words;
  if (!words.split(told)) return out;
  for (std::size_t i = 0; i < words.words().size() && i <= call.words.size(); ++i) {
    const Word &there = words.words()[i], &here = i == 0 ? call.verb : call.words[i - 1];
    const bool same = there.text == here.text && there.quoted == here.quoted;
    out.push_back({there.column, here.column, same ? static_cast<int>(here.text.size()) : 0});
  }
  return out;
}

}  // namespace

Outcome Dispatch::execute(Source& source, Session* session, const LineWords& words, std::string_view line,
                          const Scope& scope, std::string& out) {
  const Words all = words.words();
  Call call{manager_, source, session, scope, all[0], all.subspan(1), line, out};
  const Command* command = command_for(all[0], session);
  if (command == nullptr) return say_to_program(call);
  if (Status may = may_say(call, *command); !may) return may;
  if (manager_.options().check && command->effect != Effect::change) return check_only(call, *command);
  const bool kept = manager_.recorder.journal() != nullptr && !manager_.playback.replaying() && is_journaled(*command);
  if (kept)
    if (Status room = manager_.recorder.room_for(line.size() + source.name.size() + scope.prefix.size() + 256); !room)
      return room;
  return command->effect == Effect::change ? change(call, *command, kept) : steer(call, *command, kept);
}

const Command* Dispatch::command_for(const Word& verb, const Session* session) const {
  if (verb.quoted) return nullptr;
  const Command* command = find_command(verb.text);
  if (command == nullptr && session != nullptr && session->abbreviates()) command = abbreviated(verb.text);
  return command;
}

Status Dispatch::may_say(const Call& call, const Command& command) const {
  if (call.words.size() < command.least || call.words.size() > command.most) {
    const bool few = call.words.size() < command.least || call.words.empty();
    const Word& at = !few ? call.words[command.most] : call.words.empty() ? call.verb : call.words.back();
    return Error{
        ErrorKind::syntax,
        "expected " + std::string(command.name) + (command.syntax.empty() ? "" : " ") + std::string(command.syntax),
        at.column};
  }
  if (command.effect == Effect::time) {
    if (call.session == nullptr || manager_.is_scheduled(*call.session))
      return call.error(-1, ErrorKind::busy,
                        std::string(command.name) + " makes time pass: only people and scripts can say it");
    if (manager_.history.in_transaction())
      return call.error(-1, ErrorKind::busy, std::string(command.name) + " makes time pass: commit or rollback first");
  }
  if (call.source.gate != nullptr && !is_for_programs(command))
    return call.error(-1, ErrorKind::owner,
                      std::string(command.name) + " is not for programs: only people and scripts can say it");
  return {};
}

Outcome Dispatch::steer(Call& call, const Command& command, bool kept) {
  Outcome outcome = command.run(call);
  if (outcome.status) monitor(call.source, call.line);
  // a program that could not be started is not started again by who goes on with the journal
  outcome.kept = kept && outcome.operation != nullptr;
  if (kept && outcome.status && !outcome.kept) manager_.recorder.add(call.source, call.scope.prefix, call.line);
  return outcome;
}

Outcome Dispatch::change(Call& call, const Command& command, bool kept) {
  Database& world = manager_.world;
  speak_as(call.source, call.line);
  const std::uint64_t mark = world.mark();
  Outcome outcome = command.run(call);
  ++manager_.counters.lines;
  if (!outcome.status) {
    world.roll_back(mark);
    return outcome;
  }
  monitor(call.source, call.line);
  if (kept) manager_.recorder.add(call.source, call.scope.prefix, call.kept.empty() ? call.line : call.kept);
  if (world.mark() != mark && !manager_.history.in_transaction() && !manager_.tick_in_flight())
    manager_.history.remember(mark);
  return outcome;
}

void Dispatch::speak_as(const Source& source, std::string_view line) {
  manager_.world.speak_as({manager_.lines.add(line),
                           static_cast<std::uint32_t>(manager_.clock.tick() + (manager_.in_tick() ? 1 : 0)),
                           source.id});
}

void Dispatch::monitor(const Source& source, std::string_view line) {
  if (monitored_ == nullptr) return;
  monitored_->event("event said " + source.name + " " + std::string(line));
}

// --check makes the objects of a script, so that what is said of them can be checked; no time passes, nothing is
// written
Outcome Dispatch::check_only(Call& call, const Command& command) {
  static constexpr std::string_view reaching_out[] = {"branch", "checkpoints", "end",     "expect", "journal", "listen",
                                                      "quit",   "replay",      "resume",  "rewind", "save",    "stats",
                                                      "trace",  "unlisten",    "monitor", "watch"};
  if (command.name == "expect") {
    std::size_t used = 0;
    const Result<Condition> condition = Condition::parse(manager_.world, call.words, call.scope, used);
    if (!condition) return condition.error();
  }
  if (std::find(std::begin(reaching_out), std::end(reaching_out), command.name) != std::end(reaching_out)) return {};
  const std::size_t said = call.out.size();
  Outcome outcome = command.run(call);
  call.out.resize(said);
  // what takes time has been read; a program must be there, so that its types are known
  if (command.name != "start") outcome.operation.reset();
  return outcome;
}

// -- verbs of programs

Outcome Dispatch::say_to_program(Call& call) {
  if (!call.verb.quoted)
    for (const auto& manipulator : manager_.programs.all())
      for (const Manipulator::Verb& verb : manipulator->verbs())
        if (verb.name == call.verb.text) return forward(call, *manipulator, verb);
  return unknown_verb(manager_, call.verb);
}

// of several shards the one that serves the object that is named first
Manipulator& Dispatch::shard_for(const Call& call, Manipulator& manipulator, const Manipulator::Verb& verb) const {
  Manipulator* addressed = &manipulator;
  if (call.words.empty()) return *addressed;
  const Result<const Object*> object = find_object(manager_.world, call.words[0], call.scope);
  if (!object) return *addressed;
  for (const auto& each : manager_.programs.all())
    for (const Manipulator::Verb& other : each->verbs())
      if (other.name == verb.name && each->serves_path((*object)->path)) addressed = each.get();
  return *addressed;
}

Outcome Dispatch::forward(Call& call, Manipulator& manipulator, const Manipulator::Verb& verb) {
  if (manager_.options().check) return {};
  if (call.session == nullptr)
    return call.error(-1, ErrorKind::busy,
                      verb.name + " is a verb of " + manipulator.name + ": only people and scripts can say it");
  if (manager_.history.in_transaction())
    return call.error(-1, ErrorKind::busy, verb.name + " acts on the world: commit or rollback first");
  Manipulator& addressed = shard_for(call, manipulator, verb);
  if (addressed.over()) return call.error(-1, ErrorKind::gone, addressed.name + " is gone");
  const std::string line = forwarded(call, verb, manager_.world);
  if (Status room = manager_.recorder.room_for(line.size() + 256); !room) return room.error();
  speak_as(call.source, call.line);
  monitor(call.source, call.line);
  return ask(addressed, line, &call);
}

std::unique_ptr<Operation> Dispatch::ask(Manipulator& manipulator, std::string_view line, const Call* said) {
  const std::uint64_t number = manipulator.ask(line);
  Source asked;
  asked.name = ask_source;
  manager_.recorder.add(asked, "", manipulator.name + " " + std::to_string(number) + " " + std::string(line));
  return std::make_unique<Asked>(manipulator.name, number,
                                 said == nullptr ? std::vector<Place>() : places_of(*said, line));
}

}  // namespace manager
