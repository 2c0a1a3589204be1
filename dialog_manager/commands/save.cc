#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/written_down.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
namespace manager {
namespace {

using namespace objdb;

// a file is whole or not there: written beside, then moved into place; a pipe or a device is written as it is
Status write_file(std::string path, std::string_view text) {
  std::error_code ignored;
  if (std::filesystem::is_symlink(path, ignored)) path = std::filesystem::weakly_canonical(path, ignored).string();
  const bool in_place = std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored);
  const std::string beside = in_place ? path : path + ".part";
  // both ends of a pipe are opened, so that opening does not wait for its reader
  int access = std::filesystem::is_fifo(path, ignored) ? O_RDWR : O_WRONLY | O_CREAT | O_TRUNC;
  if (!in_place) {
    // what lies there is the rest of a save that was cut off, or a trap: a link to something else of ours
    ::unlink(beside.c_str());
    access |= O_EXCL | O_NOFOLLOW;
  }
  const int file = ::open(beside.c_str(), access | O_CLOEXEC | O_NONBLOCK, 0666);
  const auto failed = [&] {
    const int code = errno;
    if (file >= 0) ::close(file);
    if (!in_place) ::unlink(beside.c_str());
    return Error{ErrorKind::io, path + " cannot be written: " + std::strerror(code), 0};
  };
  if (file < 0) return failed();
  while (!text.empty()) {
    const ssize_t count = ::write(file, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failed();
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  if (in_place) {
    ::close(file);
    return {};
  }
  if (::fsync(file) != 0) return failed();
  if (::rename(beside.c_str(), path.c_str()) != 0) return failed();
  ::close(file);
  return {};
}

Outcome run(Call& call) {
  const Word file = call.words.empty() ? call.verb : call.words[0];
  const auto write = [path = std::string(call.words.empty() ? "" : file.text), column = file.column](
                         Manager& manager, std::string& out) -> Status {
    const std::string text = objdb::save(manager.world);
    if (path.empty()) {
      out += text;
      return {};
    }
    Status written = write_file(path, text);
    return written ? written : Error{written.error().kind, written.error().sentence, column};
  };
  return with_written_down(call.manager, call.out, write);
}

}  // namespace

extern const Command command_save;
const Command command_save = {"save",
                              "[FILE]",
                              "Writes the world as a script that makes it again, with the same hash; without a file "
                              "prints it. The programs write "
                              "down their private state before (not within a transaction).",
                              Effect::control,
                              0,
                              1,
                              run};

}  // namespace manager
