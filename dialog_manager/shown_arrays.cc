#include "dialog_manager/shown_arrays.h"

#include "dialog_manager/array_frames.h"
#include "objdb/statement.h"

namespace manager {

using namespace objdb;

void ShownArrays::say(std::string& out, const Frame& frame, bool shares) {
  const FrameBlock* block = shares ? frame_of(frame.numbers) : nullptr;
  if (block == nullptr) {
    append_set(out, world_, frame.path, *frame.field, frame.numbers);
    return;
  }
  const std::string name = frame.path + "." + frame.field->name;
  const ArrayMemory& memory = *block->slots->memory;
  Shown& shown = shown_[{frame.object, frame.field}];
  if (shown.memory != memory.serial()) {
    shown.memory = memory.serial();
    out += "array " + name + " read=" + memory.path() + " capacity=" + std::to_string(memory.capacity()) + "\n";
  }
  out += "put " + name + " slot=" + std::to_string(block->slot) + " seq=" + std::to_string(block->sequence) + "\n";
  before_.push_back(std::move(shown.numbers));
  shown.numbers = frame.numbers;
}

void ShownArrays::all_read() {
  before_.clear();
  std::erase_if(shown_, [&](const auto& each) { return world_.object(each.first.first) == nullptr; });
}

void ShownArrays::end_life() {
  shown_.clear();
  before_.clear();
}

}  // namespace manager
