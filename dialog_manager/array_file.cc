#include "dialog_manager/array_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>

#include "dialog_manager/count.h"
#include "objdb/value.h"

namespace manager {
namespace {

using namespace objdb;

static_assert(std::endian::native == std::endian::little, "numbers are kept with their little end first");

Error io_error(const std::string& path, std::string_view what) {
  return {ErrorKind::io,
          "arrays " + path + " " + std::string(what) + (errno == 0 ? "" : std::string(": ") + std::strerror(errno)), 0};
}

}  // namespace

Result<std::unique_ptr<ArrayFile>> ArrayFile::open(const std::string& path) {
  std::unique_ptr<ArrayFile> arrays(new ArrayFile);
  arrays->path_ = path;
  arrays->file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
  struct stat status {};
  if (arrays->file_ < 0 || ::fstat(arrays->file_, &status) != 0) return io_error(path, "cannot be opened");
  errno = 0;
  if (!S_ISREG(status.st_mode)) return io_error(path, "is no regular file");
  if (status.st_uid != ::geteuid() || (status.st_mode & 022) != 0)
    return io_error(path, "can be written by others, expected a file of ours, mode 0600");
  arrays->size_ = static_cast<std::uint64_t>(status.st_size);
  return arrays;
}

ArrayFile::~ArrayFile() {
  if (file_ >= 0) ::close(file_);
}

Result<std::string> ArrayFile::add(const Numbers& numbers) {
  const char* bytes = reinterpret_cast<const char*>(numbers.data());
  const std::size_t size = numbers.span().size_bytes();
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = ::pwrite(file_, bytes + done, size - done, static_cast<off_t>(size_ + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return io_error(path_, "cannot grow");
    done += static_cast<std::size_t>(count);
  }
  char check[17] = {};
  std::to_chars(check, check + 16, numbers.hash(), 16);
  std::string out = "count=" + std::to_string(numbers.size()) + " at=" + std::to_string(size_) + " check=" + check;
  size_ += done;
  unsynced_ = true;
  return out;
}

bool ArrayFile::sync() {
  if (!unsynced_) return true;
  unsynced_ = false;
  return ::fdatasync(file_) == 0;
}

Result<std::vector<double>> ArrayFile::read(const std::string& path, Words words) {
  const Error wrong{ErrorKind::syntax, "expected count=N at=BYTE check=HEX", 0};
  if (words.size() != 3) return wrong;
  const auto said_count = parse_count_of("count=", words[0].text), said_at = parse_count_of("at=", words[1].text),
             said_check = parse_count_of("check=", words[2].text, 16);
  if (!said_count || !said_at || !said_check) return wrong;
  const std::uint64_t count = *said_count, at = *said_at, check = *said_check;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0) return io_error(path, "cannot be read");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  std::vector<double> out;
  std::size_t done = 0;
  errno = 0;
  if (at <= size && count <= (size - at) / sizeof(double)) {
    out.resize(count);
    while (done < count * sizeof(double)) {
      const ssize_t got = ::pread(file, reinterpret_cast<char*>(out.data()) + done, count * sizeof(double) - done,
                                  static_cast<off_t>(at + done));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      done += static_cast<std::size_t>(got);
    }
  }
  ::close(file);
  if (out.size() != count || done != count * sizeof(double))
    return io_error(path, "has " + std::to_string(size) + " bytes, expected " + std::to_string(count) +
                              " numbers at byte " + std::to_string(at));
  if (hash_numbers(out) != check)
    return io_error(path, "was changed: the check of the array at byte " + std::to_string(at) + " is another");
  return out;
}

}  // namespace manager
