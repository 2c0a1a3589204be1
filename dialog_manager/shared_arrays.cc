#include "dialog_manager/shared_arrays.h"

namespace manager {

using namespace objdb;

bool is_long(const Value& value) {
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  return numbers != nullptr && numbers->size() >= long_array;
}

void SharedArrays::announce(const Object& object, int field, std::shared_ptr<ArrayMemory> memory,
                            std::uint64_t sequence) {
  announced_[{object.id, field}] = {std::move(memory), sequence,
                                    object.slots[static_cast<std::size_t>(field)].origin.line};
}

const SharedArrays::Announced* SharedArrays::announced(const Object& object, int field) const {
  const auto found = announced_.find({object.id, field});
  if (found == announced_.end()) return nullptr;
  return found->second.line == object.slots[static_cast<std::size_t>(field)].origin.line ? &found->second : nullptr;
}

std::shared_ptr<const Frame> SharedArrays::frame(const Object& object, int field) {
  Copy& copy = copies_[{object.id, field}];
  const Slot& slot = object.slots[static_cast<std::size_t>(field)];
  if (!copy.frame || copy.origin.line != slot.origin.line || copy.event != slot.event) {
    copy.origin = slot.origin;
    copy.event = slot.event;
    copy.frame = std::make_shared<Frame>(Frame{object.path, &object.type->field(field), slot.value});
  }
  return copy.frame;
}

void SharedArrays::forget_dead(const Database& world) {
  const auto dead = [&](const auto& each) { return world.object(each.first.first) == nullptr; };
  std::erase_if(announced_, dead);
  std::erase_if(copies_, dead);
}

}  // namespace manager
