#include "manipulators/kit/shared_array.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

namespace kit {
namespace {

constexpr std::size_t page = 4096;

struct Header {
  char magic[8];
  std::uint64_t capacity;
};
struct SlotHeader {
  std::uint64_t sequence, count;
};

std::size_t stride_of(std::size_t capacity) { return (capacity * sizeof(double) + page - 1) / page * page; }

SlotHeader* header_of(std::byte* bytes, std::uint64_t slot) {
  return reinterpret_cast<SlotHeader*>(bytes + 64 * (slot + 1));
}

}  // namespace

std::unique_ptr<SharedArray> SharedArray::open(const std::string& path, bool fill) {
  const int file = ::open(path.c_str(), (fill ? O_RDWR : O_RDONLY) | O_CLOEXEC);
  struct stat status {};
  if (file < 0) return nullptr;
  const bool sized = ::fstat(file, &status) == 0 && status.st_size >= static_cast<off_t>(page);
  const auto size = static_cast<std::size_t>(status.st_size);
  void* at = sized ? ::mmap(nullptr, size, fill ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED, file, 0) : MAP_FAILED;
  ::close(file);
  if (at == MAP_FAILED) return nullptr;
  std::unique_ptr<SharedArray> array(new SharedArray);
  array->bytes_ = static_cast<std::byte*>(at);
  array->size_ = size;
  Header header;
  std::memcpy(&header, array->bytes_, sizeof header);
  array->capacity_ = header.capacity;
  const bool whole = std::memcmp(header.magic, "sailor_a", 8) == 0 && header.capacity < size / sizeof(double) &&
                     size == page + slots * stride_of(header.capacity);
  return whole ? std::move(array) : nullptr;
}

SharedArray::~SharedArray() { ::munmap(bytes_, size_); }

std::uint64_t SharedArray::fill(std::span<const double> numbers) {
  const std::uint64_t slot = slot_of(++sequence_);
  SlotHeader* header = header_of(bytes_, slot);
  const std::atomic_ref<std::uint64_t> filled(header->sequence);
  // who reads it while it is filled finds no sequence
  filled.store(0, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  std::memcpy(bytes_ + page + slot * stride_of(capacity_), numbers.data(), numbers.size_bytes());
  header->count = numbers.size();
  filled.store(sequence_, std::memory_order_release);
  return sequence_;
}

bool SharedArray::read(std::uint64_t sequence, std::vector<double>& numbers) const {
  const std::uint64_t slot = slot_of(sequence);
  SlotHeader* header = header_of(bytes_, slot);
  const std::atomic_ref<std::uint64_t> filled(header->sequence);
  if (filled.load(std::memory_order_acquire) != sequence || header->count > capacity_) return false;
  const auto* from = reinterpret_cast<const double*>(bytes_ + page + slot * stride_of(capacity_));
  numbers.assign(from, from + header->count);
  std::atomic_thread_fence(std::memory_order_acquire);
  return filled.load(std::memory_order_relaxed) == sequence;
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
