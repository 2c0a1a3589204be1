#include "dialog_manager/array_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

namespace manager {
namespace {

using namespace objdb;

constexpr std::size_t page = 4096;

struct Header {  // of the memory; those of the slots follow at 64, 128, 192
  char magic[8];
  std::uint64_t capacity;
};
struct SlotHeader {
  std::uint64_t sequence, count;
};

std::size_t stride_of(std::size_t capacity) { return (capacity * sizeof(double) + page - 1) / page * page; }

std::string proc_path(int file) { return "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file); }

Error limit_error(const char* what, int code) {
  return {ErrorKind::limit, std::string("shared memory ") + what + ": " + std::strerror(code), 0};
}

// a number times 0 is 0, unless it is not finite
bool all_finite(const std::vector<double>& numbers) {
  double sum[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= numbers.size(); i += 8)
    for (std::size_t lane = 0; lane < 8; ++lane) sum[lane] += numbers[i + lane] * 0;
  for (; i < numbers.size(); ++i) sum[0] += numbers[i] * 0;
  double total = 0;
  for (const double each : sum) total += each;
  return total == 0;
}

}  // namespace

Result<std::shared_ptr<ArrayMemory>> ArrayMemory::make(std::size_t capacity) {
  static std::uint64_t made = 0;
  std::shared_ptr<ArrayMemory> memory(new ArrayMemory);
  memory->capacity_ = capacity;
  memory->size_ = page + slots * stride_of(capacity);
  memory->file_ = ::memfd_create("array", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (memory->file_ < 0) return limit_error("cannot be made", errno);
  // a sparse file would end in a signal when the machine is full; this one is there or is not
  if (const int error = ::posix_fallocate(memory->file_, 0, static_cast<off_t>(memory->size_)); error != 0)
    return limit_error("has no room", error);
  if (::fcntl(memory->file_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
    return limit_error("cannot be sealed", errno);
  void* at = ::mmap(nullptr, memory->size_, PROT_READ | PROT_WRITE, MAP_SHARED, memory->file_, 0);
  if (at == MAP_FAILED) return limit_error("cannot be mapped", errno);
  memory->bytes_ = static_cast<std::byte*>(at);
  const Header header{{'s', 'a', 'i', 'l', 'o', 'r', '_', 'a'}, capacity};
  std::memcpy(memory->bytes_, &header, sizeof header);
  memory->serial_ = ++made;
  return memory;
}

ArrayMemory::~ArrayMemory() {
  if (bytes_ != nullptr) ::munmap(bytes_, size_);
  if (file_ >= 0) ::close(file_);
}

std::string ArrayMemory::path() const { return proc_path(file_); }

Result<std::vector<double>> ArrayMemory::read(std::uint64_t sequence) const {
  const std::uint64_t slot = sequence % slots;
  SlotHeader* header = reinterpret_cast<SlotHeader*>(bytes_ + 64 * (slot + 1));
  const std::atomic_ref<std::uint64_t> filled(header->sequence);
  const auto stale = [&](std::uint64_t found) {
    return Error{ErrorKind::range,
                 "slot " + std::to_string(slot) + " holds sequence " + std::to_string(found) + ", expected " +
                     std::to_string(sequence),
                 1};
  };
  if (const std::uint64_t found = filled.load(std::memory_order_acquire); found != sequence) return stale(found);
  const std::uint64_t count = header->count;
  if (count > capacity_)
    return Error{ErrorKind::range,
                 "slot " + std::to_string(slot) + " holds " + std::to_string(count) + " numbers, expected at most " +
                     std::to_string(capacity_),
                 1};
  const auto* from = reinterpret_cast<const double*>(bytes_ + page + slot * stride_of(capacity_));
  std::vector<double> out(from, from + count);
  std::atomic_thread_fence(std::memory_order_acquire);
  if (const std::uint64_t found = filled.load(std::memory_order_relaxed); found != sequence) return stale(found);
  if (!all_finite(out))
    return Error{ErrorKind::range, "slot " + std::to_string(slot) + " holds a number that is not finite", 1};
  return out;
}

ArrayProbe::ArrayProbe() {
  unsigned char chance[8];
  file_ = ::memfd_create("probe", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (file_ < 0 || ::getrandom(chance, sizeof chance, 0) != sizeof chance) return;
  std::string word;
  for (const unsigned char each : chance) {
    word += "0123456789abcdef"[each >> 4];
    word += "0123456789abcdef"[each & 15];
  }
  if (::write(file_, word.data(), word.size()) != static_cast<ssize_t>(word.size())) return;
  ::fcntl(file_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL);
  text_ = proc_path(file_) + "," + word;
}

ArrayProbe::~ArrayProbe() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace manager
