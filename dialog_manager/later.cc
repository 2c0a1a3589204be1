#include "dialog_manager/later.h"

#include "dialog_manager/manager.h"

namespace manager {

using namespace objdb;

Result<Schedule::Entry> command_for_later(const Call& call, std::size_t index) {
  Schedule::Entry entry;
  // one quoted word is the command itself, otherwise it is the rest of the line
  const bool quoted = index + 1 == call.words.size() && call.words[index].quoted;
  entry.command = quoted ? call.words[index].text : call.rest(index);
  entry.scope = call.scope;
  entry.where = call.source.name;
  if (call.session != nullptr)
    if (const Input* input = call.session->input())
      entry.where = input->where.empty() ? input->name + ":" + std::to_string(input->line) : input->where;
  LineWords words;
  if (Status split = words.split(entry.command); !split)
    return call.error(static_cast<int>(index), split.error().kind, split.error().sentence);
  if (words.empty()) return call.error(static_cast<int>(index), ErrorKind::syntax, "expected a command");
  if (!words.tag().empty())
    return call.error(static_cast<int>(index), ErrorKind::syntax,
                      quote("@" + std::string(words.tag())) + ": what is said later is answered to nobody");
  const std::string_view verb = words.words()[0].text;
  bool known = false;
  if (const Command* command = find_command(verb)) {
    known = true;
    if (command->effect == Effect::time)
      return call.error(static_cast<int>(index), ErrorKind::busy,
                        quote(verb) + " makes time pass and cannot be said later");
    if (verb == "begin" || verb == "commit" || verb == "rollback")
      return call.error(static_cast<int>(index), ErrorKind::busy,
                        quote(verb) + " cannot be said later: a transaction belongs to one conversation");
  }
  for (const auto& manipulator : call.manager.programs.all())
    for (const Manipulator::Verb& each : manipulator->verbs()) known = known || each.name == verb;
  // a journal is also carried out without the programs whose verbs it puts off
  if (!known && !call.manager.playback.replaying())
    return call.error(static_cast<int>(index), ErrorKind::unknown, "no verb " + quote(verb));
  return entry;
}

void print_entries(std::string& out, const Schedule& schedule, Schedule::Entry::Kind kind) {
  for (const Schedule::Entry& entry : schedule.entries()) {
    if (entry.kind != kind) continue;
    out += std::to_string(entry.id) + " ";
    if (entry.kind == Schedule::Entry::Kind::when)
      out += entry.condition->text();
    else
      append_number(out, entry.kind == Schedule::Entry::Kind::at ? entry.time : entry.period);
    out += " " + entry.command + "\n";
  }
}

}  // namespace manager
