#include "dialog_manager/command.h"

#include <tsl/robin_map.h>

namespace manager {

std::string_view Call::rest(std::size_t index) const {
  return index < words.size() ? line.substr(static_cast<std::size_t>(words[index].column) - 1) : std::string_view();
}

objdb::Error Call::error(int index, objdb::ErrorKind kind, std::string sentence) const {
  const objdb::Word& word =
      index < 0 || static_cast<std::size_t>(index) >= words.size() ? verb : words[static_cast<std::size_t>(index)];
  return {kind, std::move(sentence), word.column};
}

const Command* find_command(std::string_view name) {
  static const auto index = [] {
    tsl::robin_map<std::string_view, const Command*> out;
    for (const Command* command : commands()) out.emplace(command->name, command);
    return out;
  }();
  const auto found = index.find(name);
  return found == index.end() ? nullptr : found->second;
}

}  // namespace manager
