#include "dialog_manager/array_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "objdb/text.h"

namespace manager {
namespace {

using namespace objdb;

std::string proc_path(int file) { return "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file); }

Error limit_error(const char* what, int code) {
  return {ErrorKind::limit, std::string("shared memory ") + what + ": " + std::strerror(code), 0};
}

}  // namespace

Result<std::shared_ptr<ArrayMemory>> ArrayMemory::make(std::size_t capacity, std::size_t slots, Writer writer) {
  static std::uint64_t made = 0;
  std::shared_ptr<ArrayMemory> memory(new ArrayMemory);
  memory->capacity_ = capacity;
  memory->slots_ = slots;
  memory->size_ = array_layout::size(capacity, slots);
  memory->file_ = ::memfd_create("array", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (memory->file_ < 0) return limit_error("cannot be made", errno);
  // a sparse file would end in a signal when the machine is full; this one is there or is not
  if (const int error = ::posix_fallocate(memory->file_, 0, static_cast<off_t>(memory->size_)); error != 0)
    return limit_error("has no room", error);
  // no page is waited for later
  void* at = ::mmap(nullptr, memory->size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, memory->file_, 0);
  if (at == MAP_FAILED) return limit_error("cannot be mapped", errno);
  memory->bytes_ = static_cast<std::byte*>(at);
  const int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL | (writer == Writer::manager ? F_SEAL_FUTURE_WRITE : 0);
  array_layout::Header header{{}, capacity, slots};
  array_layout::magic.copy(header.magic, sizeof header.magic);
  std::memcpy(memory->bytes_, &header, sizeof header);
  if (::fcntl(memory->file_, F_ADD_SEALS, seals) != 0) return limit_error("cannot be sealed", errno);
  memory->serial_ = ++made;
  return memory;
}

ArrayMemory::~ArrayMemory() {
  if (bytes_ != nullptr) ::munmap(bytes_, size_);
  if (file_ >= 0) ::close(file_);
}

std::string ArrayMemory::path() const { return proc_path(file_); }

ArrayProbe::ArrayProbe() {
  unsigned char chance[8];
  file_ = ::memfd_create("probe", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (file_ < 0 || ::getrandom(chance, sizeof chance, 0) != sizeof chance) return;
  std::string word;
  for (const unsigned char each : chance) append_hexadecimal(word, each, 2);
  if (::write(file_, word.data(), word.size()) != static_cast<ssize_t>(word.size())) return;
  ::fcntl(file_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL);
  text_ = proc_path(file_) + "," + word;
}

ArrayProbe::~ArrayProbe() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace manager
