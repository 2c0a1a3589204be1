#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

struct Entry {
  std::string name, syntax, doc;
};

std::vector<Entry> entries(const Manager& manager) {
  std::vector<Entry> out;
  for (const Command* command : commands())
    out.push_back({std::string(command->name), std::string(command->syntax), std::string(command->doc)});
  for (const auto& manipulator : manager.programs.all())
    for (const Manipulator::Verb& verb : manipulator->verbs())
      out.push_back({verb.name, verb.syntax, verb.doc + " (" + manipulator->name + ")"});
  return out;
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

Outcome run(Call& call) {
  const bool by_word = call.words.size() == 2 && call.words[0].text == "-k";
  if (call.words.size() == 2 && !by_word)
    return call.error(1, ErrorKind::syntax, "expected help [WORD] or help -k WORD");
  const std::string wanted = call.words.empty() ? "" : std::string(call.words.back().text);
  bool any = false;
  for (const Entry& entry : entries(call.manager)) {
    const std::string head = entry.name + (entry.syntax.empty() ? "" : " " + entry.syntax);
    if (by_word ? lower(head + " " + entry.doc).find(lower(wanted)) == std::string::npos
                : !wanted.empty() && entry.name != wanted)
      continue;
    any = true;
    call.out += head + "\n    " + entry.doc + "\n";
  }
  if (!any)
    return call.error(static_cast<int>(call.words.size()) - 1, ErrorKind::unknown,
                      "no verb " + quote(wanted) + (by_word ? " is spoken of" : ""));
  return {};
}

}  // namespace

extern const Command command_help;
const Command command_help = {"help",
                              "[WORD] | -k WORD",
                              "Prints every verb, one verb, or (-k) the verbs that speak of a word.",
                              Effect::look,
                              0,
                              2,
                              run};

}  // namespace manager
