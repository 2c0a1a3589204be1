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

constexpr std::size_t page = 4096, line = 64;

struct Header {
  char magic[8];
  std::uint64_t capacity, slots;
};

std::size_t stride_of(std::size_t capacity) { return (line + capacity * sizeof(double) + page - 1) / page * page; }

// the slot will hold other numbers one day: who wants to keep these copies them
struct View : NumberBlock {
  View(std::span<const double> numbers, std::shared_ptr<const SharedArray> from)
      : NumberBlock(numbers, false), array(std::move(from)) {}
  std::shared_ptr<const SharedArray> array;
};

}  // namespace

struct SharedArray::Head {
  std::uint64_t sequence, count;
};

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
  Header header;
  std::memcpy(&header, array->bytes_, sizeof header);
  array->capacity_ = header.capacity;
  array->slots_ = header.slots;
  const bool whole = std::memcmp(header.magic, "sailor_b", 8) == 0 && header.slots > 0 && header.slots < size / page &&
                     header.capacity < size / sizeof(double) &&
                     size == page + header.slots * stride_of(header.capacity);
  return whole ? array : nullptr;
}

SharedArray::~SharedArray() { ::munmap(bytes_, size_); }

SharedArray::Head* SharedArray::head(std::uint64_t slot) const {
  return reinterpret_cast<Head*>(bytes_ + page + slot * stride_of(capacity_));
}

double* SharedArray::numbers(std::uint64_t slot) const {
  return reinterpret_cast<double*>(bytes_ + page + slot * stride_of(capacity_) + line);
}

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
