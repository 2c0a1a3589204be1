#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace manager {

class Manager;

/// What may stand at the end of a line.
struct Completion {
  std::size_t start = 0;           ///< of the word that is being typed
  std::vector<std::string> words;  ///< what it may become, sorted; with a blank behind when nothing else can follow
  std::size_t hidden = 0;          ///< bytes that a list of them leaves away: the folder that all stand in
  std::string hint;                ///< how the command goes on, when there is nothing to offer
};

/// Verbs first; then what the verb's syntax names in this place: its own words, and types, objects, fields, files,
/// programs as the live world has them; after PATH.FIELD the words of an enumeration.
Completion complete(const Manager& manager, const std::string& line);

}  // namespace manager
