#include <algorithm>

#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/screen_text.h"

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

// at a prompt: a row for each verb, with the first sentence of its meaning
void tell_briefly(Call& call) {
  const std::vector<Entry> all = entries(call.manager);
  std::size_t longest = 0;
  for (const Entry& entry : all) longest = std::max(longest, entry.name.size());
  for (const Entry& entry : all) {
    std::string row = entry.name + std::string(longest - entry.name.size() + 2, ' ') +
                      entry.doc.substr(0, entry.doc.find_first_of(".;:("));
    const std::size_t columns = call.manager.columns();
    if (row.size() > columns) row.replace(columns - std::min<std::size_t>(columns, 3), std::string::npos, "...");
    call.out += row + "\n";
  }
  call.out += "help VERB tells more; help -k WORD finds verbs; describe TYPE or PATH tells what a thing is.\n";
}

Outcome run(Call& call) {
  if (call.words.empty() && call.manager.columns() > 0) {
    tell_briefly(call);
    return {};
  }
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
    call.out += wrapped(head + "\n    " + entry.doc + "\n", call.manager.columns());
  }
  std::vector<std::string_view> names;
  const std::vector<Entry> all = entries(call.manager);
  for (const Entry& entry : all) names.push_back(entry.name);
  if (!any)
    return call.error(
        static_cast<int>(call.words.size()) - 1, ErrorKind::unknown,
        "no verb " + (by_word ? "speaks of " + quote(wanted) : quote(wanted) + did_you_mean(wanted, names)));
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
