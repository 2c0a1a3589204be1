// A disk that fails, and a manager that is killed, at a system call that can be told: laid over the C library with
// LD_PRELOAD.  FAILING="CALL N WHAT": the Nth CALL (pwrite fdatasync fallocate ftruncate, or write to standard output,
// through whatever descriptor) and with "N+" every one after it. WHAT is an errno, or: short (half of the bytes), kill
// (dies before), killed (dies after).

#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

struct Order {
  char call[32] = "", what[32] = "";
  long number = 0;
  bool onwards = false;
  long seen = 0;
};

Order& order() {
  static Order told = [] {
    Order out;
    char count[32] = "";
    if (const char* text = std::getenv("FAILING"))
      if (std::sscanf(text, "%31s %31s %31s", out.call, count, out.what) != 3) std::abort();
    out.number = std::atol(count);
    out.onwards = std::strchr(count, '+') != nullptr;
    return out;
  }();
  return told;
}

// what is to happen now, "" for nothing
std::string now(const char* call) {
  Order& told = order();
  if (std::strcmp(told.call, call) != 0) return "";
  ++told.seen;
  if (told.seen == told.number || (told.onwards && told.seen > told.number)) return told.what;
  return "";
}

template <class Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

bool is_output(int file) {
  struct stat one {
  }, other{};
  return ::fstat(file, &one) == 0 && ::fstat(STDOUT_FILENO, &other) == 0 && one.st_dev == other.st_dev &&
         one.st_ino == other.st_ino;
}

void die() { ::kill(::getpid(), SIGKILL); }

// the call under its orders; `half` is the call with half of its bytes
template <class Whole, class Half>
auto obey(const char* call, Whole whole, Half half) -> decltype(whole()) {
  const std::string what = now(call);
  if (what.empty()) return whole();
  if (what == "kill") die();
  if (what == "short") return half();
  if (what == "killed") {
    whole();
    die();
  }
  errno = std::atoi(what.c_str());
  return -1;
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, size_t count) {
  static const auto real = original<ssize_t (*)(int, const void*, size_t)>("write");
  if (!is_output(file)) return real(file, bytes, count);
  return obey(
      "write", [&] { return real(file, bytes, count); }, [&] { return real(file, bytes, (count + 1) / 2); });
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  static const auto real = original<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  return obey(
      "pwrite", [&] { return real(file, bytes, count, at); }, [&] { return real(file, bytes, (count + 1) / 2, at); });
}

int fdatasync(int file) {
  static const auto real = original<int (*)(int)>("fdatasync");
  return obey(
      "fdatasync", [&] { return real(file); }, [&] { return real(file); });
}

int ftruncate(int file, off_t size) noexcept {
  static const auto real = original<int (*)(int, off_t)>("ftruncate");
  return obey(
      "ftruncate", [&] { return real(file, size); }, [&] { return real(file, size); });
}

// this one tells its error as its value
int posix_fallocate(int file, off_t at, off_t size) {
  static const auto real = original<int (*)(int, off_t, off_t)>("posix_fallocate");
  const int status = obey(
      "fallocate", [&] { return real(file, at, size); }, [&] { return real(file, at, size); });
  return status == -1 ? errno : status;
}

ssize_t pwrite64(int file, const void* bytes, size_t count, off_t at) { return pwrite(file, bytes, count, at); }
int ftruncate64(int file, off_t size) noexcept { return ftruncate(file, size); }
int posix_fallocate64(int file, off_t at, off_t size) { return posix_fallocate(file, at, size); }
}
