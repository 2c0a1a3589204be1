#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dialog_manager/array_memory.h"
#include "objdb/numbers.h"

namespace manager {

/// Slots of a memory that the manager alone writes, each free again when nobody holds the numbers in it any more.
struct FrameSlots {
  std::shared_ptr<ArrayMemory> memory;
  std::vector<std::size_t> free;
};

/// Numbers in such a slot: the value of a field, which programs read where it stands.
struct FrameBlock : objdb::NumberBlock {
  FrameBlock(std::shared_ptr<FrameSlots> slots, std::uint64_t sequence, std::size_t count);
  ~FrameBlock() override;

  std::shared_ptr<FrameSlots> slots;
  std::size_t slot;
  std::uint64_t sequence;
};

/// The frame that these numbers are; null when they stand in memory of the manager's own.
const FrameBlock* frame_of(const objdb::Numbers& numbers);

/// The frames of one array: one after the other comes from the program that fills it, and stays for as long as the
/// world, what can be taken back, what must be told again or a program that reads it holds it. As many slots are there
/// as were held at once.
class ArrayFrames {
 public:
  /// Of arrays of at most `capacity` numbers.
  explicit ArrayFrames(std::size_t capacity) : capacity_(capacity) {}

  /// The numbers that a program has put into its slot of this sequence, taken over: copied once, so that what it does
  /// with the slot afterwards is its own affair, and seen to be finite as they are here.
  /// Errors: range (another sequence before or after, too many, a number that is not finite).
  objdb::Result<objdb::Numbers> take(const ArrayMemory& filled, std::uint64_t sequence);
  /// Why there is no (more) shared memory; ok() while there is. The numbers are in memory of the manager's own then.
  const objdb::Status& room() const { return room_; }

 private:
  std::shared_ptr<FrameBlock> place(std::size_t count);
  bool grow();
  void shrink();

  std::size_t capacity_;
  std::shared_ptr<FrameSlots> slots_;
  std::uint64_t sequence_ = 0;
  std::size_t most_held_ = 0, taken_ = 0;  // since it was last looked whether there are too many slots
  objdb::Status room_;
};

}  // namespace manager
