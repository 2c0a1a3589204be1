#include "dialog_manager/handshake.h"

#include "dialog_manager/manager.h"
#include "dialog_manager/said_error.h"

namespace manager {
namespace {

using namespace objdb;

std::string hello_line(Manager& manager, const std::string& name) {
  std::string line = "hello protocol=1 name=" + name + " seed=" + std::to_string(manager.options().seed) +
                     " tick=" + number(manager.clock.step()) +
                     (manager.probe().empty() ? " arrays=text" : " arrays=shm probe=" + manager.probe()) + " schema=";
  append_hexadecimal(line, manager.world.schema().hash());
  return line + '\n';
}

}  // namespace

const std::string& Handshake::begin() {
  declaring_ = {};
  if (hello_.empty()) hello_ = hello_line(manager_, program_.name);
  return hello_;
}

Result<bool> Handshake::take(std::string_view line) {
  if (Status split = words_.split(line); !split)
    return Error{split.error().kind, program_.name + " said: " + split.error().sentence, 0};
  if (words_.empty()) return false;
  // why it cannot be what it is
  if (words_.words()[0].text == "error") {
    const Error error = parse_said_error(line);
    return Error{error.kind, program_.name + ": " + error.sentence, 0};
  }
  Result<bool> ready = declare(words_.words(), line);
  if (ready) return ready;
  return Error{ready.error().kind,
               program_.name + ": " + ready.error().sentence + " (in: " + std::string(line.substr(0, 200)) + ")", 0};
}

Result<bool> Handshake::declare(Words words, std::string_view line) {
  const std::string_view verb = words[0].text;
  if (verb == "ready") return true;
  if (verb == "verb" && words.size() > 1)
    if (Status free = free_verb(words[1]); !free) return free.error();
  if (Status taken = declaring_.take(words, manager_.world); !taken) return taken.error();
  // another life says them again
  if ((verb == "type" || verb == "field") && !program_.begun()) manager_.recorder.add(program_, "", line);
  return false;
}

// shards of one program offer the same verbs
Status Handshake::free_verb(const Word& name) const {
  if (find_command(name.text) != nullptr)
    return Error{ErrorKind::exists, "verb " + std::string(name.text) + " is the manager's own", name.column};
  for (const auto& other : manager_.programs.all()) {
    if (other.get() == &program_ || other->program() == program_.program() || other->state() == Life::State::failed)
      continue;
    for (const Declaration::Verb& known : other->verbs())
      if (known.name == name.text)
        return Error{ErrorKind::exists, "verb " + known.name + " is offered by " + other->name, name.column};
  }
  return {};
}

}  // namespace manager
