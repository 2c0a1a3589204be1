#include "dialog_manager/array_frames.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <string>
#include <utility>

namespace manager {
namespace {

using namespace objdb;

constexpr std::size_t fewest = 4;
// how many frames are taken until slots that were never needed meanwhile are given back
constexpr std::size_t patience = 512;

// what is looked at are the numbers that are here, whoever writes over those that were there
bool copy_finite(const double* from, std::span<double> to) {
  constexpr std::size_t piece = 512;
  bool finite = true;
  for (std::size_t at = 0; at < to.size(); at += piece) {
    const std::span<double> here = to.subspan(at, std::min(piece, to.size() - at));
    std::memcpy(here.data(), from + at, here.size_bytes());
    std::atomic_signal_fence(std::memory_order_seq_cst);
    finite = all_finite(here) && finite;
  }
  return finite;
}

}  // namespace

FrameBlock::FrameBlock(std::shared_ptr<FrameSlots> from, std::uint64_t sequence, std::size_t count)
    : slots(std::move(from)), slot(slots->free.back()), sequence(sequence) {
  slots->free.pop_back();
  // who should still read it while it is filled finds no sequence
  std::atomic_ref<std::uint64_t>(slots->memory->head(slot)->sequence).store(0, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  numbers = {slots->memory->numbers(slot), count};
}

FrameBlock::~FrameBlock() { slots->free.push_back(slot); }

const FrameBlock* frame_of(const Numbers& numbers) { return dynamic_cast<const FrameBlock*>(numbers.block()); }

bool ArrayFrames::grow() {
  const std::size_t now = slots_ ? slots_->memory->slots() : 0, wanted = std::max(fewest, now + now / 2);
  Result<std::shared_ptr<ArrayMemory>> made = ArrayMemory::make(capacity_, wanted, ArrayMemory::Writer::manager);
  if (!made) {
    room_ = made.error();
    return false;
  }
  // what stands in the old slots stays there until it is let go
  slots_ = std::make_shared<FrameSlots>();
  slots_->memory = std::move(*made);
  for (std::size_t slot = wanted; slot > 0; --slot) slots_->free.push_back(slot - 1);
  return true;
}

void ArrayFrames::shrink() {
  const std::size_t slots = slots_->memory->slots();
  most_held_ = std::max(most_held_, slots - slots_->free.size());
  if (++taken_ < patience) return;
  if (3 * most_held_ < slots && slots > fewest) slots_.reset();
  most_held_ = taken_ = 0;
}

std::shared_ptr<FrameBlock> ArrayFrames::place(std::size_t count) {
  if (slots_ && room_) shrink();
  if ((!slots_ || slots_->free.empty()) && (!room_ || !grow())) return nullptr;
  return std::make_shared<FrameBlock>(slots_, ++sequence_, count);
}

Result<Numbers> ArrayFrames::take(const ArrayMemory& filled, std::uint64_t sequence) {
  const std::size_t slot = sequence % filled.slots();
  const auto refused = [&](const std::string& what) {
    return Error{ErrorKind::range, "slot " + std::to_string(slot) + " holds " + what, 1};
  };
  ArrayMemory::Head* head = filled.head(slot);
  const std::atomic_ref<std::uint64_t> holds(head->sequence), numbers(head->count);
  const auto other = [&](std::uint64_t found) {
    return refused("sequence " + std::to_string(found) + ", expected " + std::to_string(sequence));
  };
  if (const std::uint64_t found = holds.load(std::memory_order_acquire); found != sequence) return other(found);
  const std::uint64_t count = numbers.load(std::memory_order_relaxed);
  if (count > filled.capacity())
    return refused(std::to_string(count) + " numbers, expected at most " + std::to_string(filled.capacity()));

  std::vector<double> own;
  const std::shared_ptr<FrameBlock> frame = place(count);
  if (!frame) own.resize(count);
  const std::span<double> to = frame ? std::span(frame->slots->memory->numbers(frame->slot), count) : std::span(own);
  const bool finite = copy_finite(filled.numbers(slot), to);
  std::atomic_thread_fence(std::memory_order_acquire);
  if (const std::uint64_t found = holds.load(std::memory_order_relaxed); found != sequence) return other(found);
  if (!finite) return refused("a number that is not finite");
  if (!frame) return Numbers(std::move(own));
  ArrayMemory::Head* kept = frame->slots->memory->head(frame->slot);
  kept->count = count;
  std::atomic_ref<std::uint64_t>(kept->sequence).store(frame->sequence, std::memory_order_release);
  return Numbers(frame);
}

}  // namespace manager
