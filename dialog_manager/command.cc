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

namespace {

// enough to tell a few dozen verbs apart
struct VerbHash {
  std::size_t operator()(std::string_view name) const {
    if (name.empty()) return 0;
    const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(name[i])}; };
    return name.size() + 8 * byte(0) + 64 * byte(name.size() / 2) + 256 * byte(name.size() - 1);
  }
};

}  // namespace

const Command* find_command(std::string_view name) {
  static const auto index = [] {
    tsl::robin_map<std::string_view, const Command*, VerbHash> out;
    for (const Command* command : commands()) out.emplace(command->name, command);
    return out;
  }();
  const auto found = index.find(name);
  return found == index.end() ? nullptr : found->second;
}

}  // namespace manager
