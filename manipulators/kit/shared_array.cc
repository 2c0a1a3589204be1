#include "manipulators/kit/shared_array.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

namespace kit {
namespace {

using namespace objdb;

using array_layout::page;

// the slot will hold other numbers one day: who wants to keep these copies them
struct View : NumberBlock {
  View(std::span<const double> numbers, std::shared_ptr<const SharedArray> from)
      : NumberBlock(numbers, false), array(std::move(from)) {}
  std::shared_ptr<const SharedArray> array;
};

}  // namespace

std::shared_ptr<SharedArray> SharedArray::open(const std::string& path, bool fill) {
  const int file = ::open(path.c_str(), (fill ? O_RDWR : O_RDONLY) | O_CLOEXEC);
  struct stat status {};
  if (file < 0) return nullptr;
  const bool sized = ::fstat(file, &status) == 0 && status.st_size >= static_cast<off_t>(page);
  const auto size = static_cast<std::size_t>(status.st_size);
  // no page is waited for later
  void* at = sized
                 ? ::mmap(nullptr, size, fill ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED | MAP_POPULATE, file, 0)
                 : MAP_FAILED;
  ::close(file);
  if (at == MAP_FAILED) return nullptr;
  std::shared_ptr<SharedArray> array(new SharedArray);
  array->bytes_ = static_cast<std::byte*>(at);
  array->size_ = size;
  array_layout::Header header;
  std::memcpy(&header, array->bytes_, sizeof header);
  array->capacity_ = header.capacity;
  array->slots_ = header.slots;
  const bool whole = std::string_view(header.magic, sizeof header.magic) == array_layout::magic && header.slots > 0 &&
                     header.slots < size / page && header.capacity < size / sizeof(double) &&
                     size == array_layout::size(header.capacity, header.slots);
  return whole ? array : nullptr;
}

SharedArray::~SharedArray() { ::munmap(bytes_, size_); }

Numbers SharedArray::view(std::uint64_t slot, std::size_t count) const {
  return Numbers(std::make_shared<View>(std::span<const double>(numbers(slot), count), shared_from_this()));
}

std::span<double> SharedArray::begin(std::size_t count) {
  const std::uint64_t slot = slot_of(sequence_ + 1);
  // who reads it while it is filled finds no sequence
  std::atomic_ref<std::uint64_t>(head(slot)->sequence).store(0, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  count_ = count;
  return {numbers(slot), count};
}

Numbers SharedArray::begun() const { return view(slot_of(sequence_ + 1), count_); }

std::uint64_t SharedArray::finish() {
  Head* filled = head(slot_of(++sequence_));
  filled->count = count_;
  std::atomic_ref<std::uint64_t>(filled->sequence).store(sequence_, std::memory_order_release);
  return sequence_;
}

std::optional<Numbers> SharedArray::read(std::uint64_t slot, std::uint64_t sequence) const {
  if (slot >= slots_) return std::nullopt;
  const std::atomic_ref<std::uint64_t> holds(head(slot)->sequence);
  if (holds.load(std::memory_order_acquire) != sequence || head(slot)->count > capacity_) return std::nullopt;
  return view(slot, head(slot)->count);
}

bool shares_memory(const std::string& probe) {
  const std::size_t comma = probe.find(',');
  if (comma == std::string::npos) return false;
  const int file = ::open(probe.substr(0, comma).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return false;
  char word[64];
  const ssize_t count = ::pread(file, word, sizeof word, 0);
  ::close(file);
  return count > 0 && probe.substr(comma + 1) == std::string_view(word, static_cast<std::size_t>(count));
}

}  // namespace kit
