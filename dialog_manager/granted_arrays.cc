#include "dialog_manager/granted_arrays.h"

#include <algorithm>
#include <utility>

#include "dialog_manager/put_words.h"

namespace manager {
namespace {

using namespace objdb;

Error error_at(const Word& word, ErrorKind kind, std::string sentence) {
  return {kind, std::move(sentence), word.column};
}

}  // namespace

void GrantedArrays::begin_life() {
  granted_.clear();
  long_sets_.clear();
}

// -- memory

void GrantedArrays::note_long(const Word& word) {
  const Result<Target> target = parse_target(word);
  if (target) long_sets_.insert(std::string(target->pattern) + "." + std::string(target->field));
}

// numbers in a field that holds a long array, 0 otherwise
std::size_t GrantedArrays::long_size(std::string_view name) const {
  const std::size_t dot = name.find('.');
  const Object* object = world_.find(name.substr(0, dot));
  const int field = object == nullptr ? -1 : object->type->find(name.substr(dot + 1));
  if (field < 0 || !is_long(object->value(field))) return 0;
  return std::get<std::vector<double>>(object->value(field)).size();
}

void GrantedArrays::grant(const std::function<void(const std::string&)>& say,
                          const std::function<void(const std::string&)>& event) {
  for (const std::string& name : std::exchange(long_sets_, {})) {
    const std::size_t wanted = long_size(name);
    if (wanted == 0) continue;
    Granted& granted = granted_[name];
    if (granted.wanted >= wanted) continue;
    granted.wanted = wanted;
    Result<std::shared_ptr<ArrayMemory>> made = ArrayMemory::make(wanted);
    if (!made) {
      event("event array " + name + " stays text: " + made.error().sentence);
      continue;
    }
    granted.memory = std::move(*made);
    granted.sequence = 0;
    arrays_.forget_dead(world_);
    say("array " + name + " fill=" + granted.memory->path() + " capacity=" + std::to_string(wanted) + "\n");
  }
}

// -- what it filled

Status GrantedArrays::fill(Words words, const std::string& owner) {
  std::uint64_t slot = 0, sequence = 0;
  if (Status parsed = parse_put(words, slot, sequence); !parsed) return parsed;
  const auto found = granted_.find(words[1].text);
  if (found == granted_.end() || !found->second.memory)
    return error_at(words[1], ErrorKind::owner,
                    owner + " was given no memory for " + shown(words[1].text) + ", expected its value as text");
  Granted& granted = found->second;
  if (sequence != granted.sequence + 1)
    return error_at(words[3], ErrorKind::range,
                    "seq is " + std::to_string(sequence) + ", expected " + std::to_string(granted.sequence + 1));
  if (slot != sequence % ArrayMemory::slots)
    return error_at(words[2], ErrorKind::range,
                    "slot is " + std::to_string(slot) + ", expected " + std::to_string(sequence % ArrayMemory::slots) +
                        " (seq modulo " + std::to_string(ArrayMemory::slots) + ")");
  Result<std::vector<double>> numbers = granted.memory->read(sequence);
  if (!numbers) return error_at(words[1], numbers.error().kind, numbers.error().sentence);
  granted.sequence = sequence;
  filled_.push_back({std::string(words[1].text), sequence, granted.memory, std::move(*numbers)});
  return {};
}

Result<GrantedArrays::Filled> GrantedArrays::take(std::string_view target, std::uint64_t sequence) {
  const auto found = std::find_if(filled_.begin(), filled_.end(), [&](const Filled& each) {
    return each.target == target && each.sequence == sequence;
  });
  if (found == filled_.end())
    return Error{ErrorKind::unknown, "seq " + std::to_string(sequence) + " of " + shown(target) + " is not filled", 0};
  Filled filled = std::move(*found);
  filled_.erase(found);
  return filled;
}

}  // namespace manager
