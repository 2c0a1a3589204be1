#include "dialog_manager/granted_arrays.h"

#include <algorithm>
#include <utility>

#include "dialog_manager/put_words.h"
#include "objdb/statement.h"

namespace manager {
namespace {

using namespace objdb;

// what was announced stays as it is while the next is filled
constexpr std::size_t slots = 3;

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
  const auto* numbers = field < 0 ? nullptr : std::get_if<Numbers>(&object->value(field));
  return numbers == nullptr || numbers->size() < long_array ? 0 : numbers->size();
}

void GrantedArrays::grant(const std::function<void(const std::string&)>& say,
                          const std::function<void(const std::string&)>& event) {
  for (const std::string& name : std::exchange(long_sets_, {})) {
    const std::size_t wanted = long_size(name);
    if (wanted == 0) continue;
    Granted& granted = granted_[name];
    if (granted.wanted >= wanted) continue;
    granted.wanted = wanted;
    Result<std::shared_ptr<ArrayMemory>> made = ArrayMemory::make(wanted, slots, ArrayMemory::Writer::program);
    if (!made) {
      event("event array " + name + " stays text: " + made.error().sentence);
      continue;
    }
    granted.memory = std::move(*made);
    granted.frames = std::make_unique<ArrayFrames>(wanted);
    granted.sequence = 0;
    say("array " + name + " fill=" + granted.memory->path() + " capacity=" + std::to_string(wanted) + "\n");
  }
}

// -- what it filled

Status GrantedArrays::fill(Words words, const std::string& owner,
                           const std::function<void(const std::string&)>& event) {
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
  if (slot != sequence % slots)
    return error_at(words[2], ErrorKind::range,
                    "slot is " + std::to_string(slot) + ", expected " + std::to_string(sequence % slots) +
                        " (seq modulo " + std::to_string(slots) + ")");
  const bool had_room = granted.frames->room().ok();
  Result<Numbers> numbers = granted.frames->take(*granted.memory, sequence);
  if (const Status& room = granted.frames->room(); had_room && !room)
    event("event array " + found->first + " is told as text: " + room.error().sentence);
  if (!numbers) return error_at(words[1], numbers.error().kind, numbers.error().sentence);
  granted.sequence = sequence;
  filled_.push_back({found->first, sequence, std::move(*numbers)});
  return {};
}

Result<Numbers> GrantedArrays::take(std::string_view target, std::uint64_t sequence) {
  const auto found = std::find_if(filled_.begin(), filled_.end(), [&](const Filled& each) {
    return each.target == target && each.sequence == sequence;
  });
  if (found == filled_.end())
    return Error{ErrorKind::unknown, "seq " + std::to_string(sequence) + " of " + shown(target) + " is not filled", 0};
  Numbers numbers = std::move(found->numbers);
  filled_.erase(found);
  return numbers;
}

}  // namespace manager
