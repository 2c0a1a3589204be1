#include "dialog_manager/speakers.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

Error deaf_to(const std::string& path, ErrorKind kind, const std::string& why) {
  return {kind, path + " cannot be listened to: " + why, 0};
}

bool same_file(const std::string& one, const std::string& other) {
  struct stat a {
  }, b{};
  return ::stat(one.c_str(), &a) == 0 && ::stat(other.c_str(), &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

}  // namespace

Result<Input> Speakers::fifo_input(const std::string& path) {
  // opened anew for the writers that come after the last one left: a FIFO that has seen its end says so for ever
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0)
    return deaf_to(path, errno == EMFILE || errno == ENFILE ? ErrorKind::limit : ErrorKind::io, std::strerror(errno));
  // what lies there now may be another than before
  struct stat status {};
  ::fstat(descriptor, &status);
  const bool fifo = S_ISFIFO(status.st_mode);
  if (!fifo || status.st_uid != ::geteuid() || (status.st_mode & 022) != 0) {
    ::close(descriptor);
    return deaf_to(path, ErrorKind::io,
                   fifo ? "it can be written by others, expected a FIFO of ours, mode 0600" : "it is no FIFO");
  }
  Input input;
  input.name = path;
  input.fifo = true;
  input.live = std::make_unique<channel::Reader>(manager_.loop(), descriptor, channel::Descriptor::own, 4096);
  return input;
}

Status Speakers::listen(const std::string& path) {
  if (is_source_of_manager(path))
    return Error{ErrorKind::exists, path + " is a name of the manager's own, expected ./" + path, 0};
  // two readers of one FIFO would each get a part of its lines, whatever its names
  for (const auto& speaker : all_)
    if (speaker->name == path || same_file(speaker->name, path))
      return Error{ErrorKind::exists,
                   path + " is listened to already" + (speaker->name == path ? "" : ", as " + speaker->name), 0};
  const bool made = ::mkfifo(path.c_str(), 0600) == 0;
  if (!made && errno != EEXIST) return deaf_to(path, ErrorKind::io, std::strerror(errno));
  Result<Input> input = fifo_input(path);
  if (!input) return input.error();
  if (input->live->failed()) return deaf_to(path, ErrorKind::limit, "too many open files");
  auto session =
      std::make_unique<Session>(path, manager_.options().framed ? Session::Style::beside : Session::Style::people,
                                manager_.out(), manager_.errors());
  session->id = manager_.add_source(path);
  session->keep_going(true);
  session->limit_lines(4096);
  session->speak_beside();
  session->enqueue(std::move(*input));
  all_.push_back(std::move(session));
  if (made) made_.push_back(path);
  return {};
}

Status Speakers::unlisten(const std::string& path) {
  const auto speaker = std::find_if(all_.begin(), all_.end(), [&](const auto& each) { return each->name == path; });
  if (speaker == all_.end()) return Error{ErrorKind::unknown, path + " is not listened to", 0};
  if (manager_.history.in_transaction_of(**speaker)) manager_.history.roll_back_open();
  manager_.watches.remove(**speaker);
  manager_.dispatch.forget(**speaker);
  // a session cannot be taken away while it speaks; it ends when its lines do
  (*speaker)->stop();
  ending_.push_back(std::move(*speaker));
  all_.erase(speaker);
  if (std::erase(made_, path) > 0) ::unlink(path.c_str());
  return {};
}

void Speakers::remove_fifos() {
  for (const std::string& path : made_) ::unlink(path.c_str());
}

}  // namespace manager
