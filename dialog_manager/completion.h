#pragma once

#include <string>
#include <vector>

namespace manager {

class Manager;

/// What may stand at `start` of a line, beginning with `word`: verbs first; after them types, paths, fields, the words
/// of an enumeration, as the live world has them.
std::vector<std::string> complete(const Manager& manager, const std::string& line, std::size_t start,
                                  const std::string& word);

}  // namespace manager
