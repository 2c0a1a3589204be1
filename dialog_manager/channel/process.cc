#include "dialog_manager/channel/process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

namespace channel {
namespace {

using objdb::Error;
using objdb::ErrorKind;

// two ends, both closed on exec; -1 when they could not be made
struct Pipe {
  int read = -1, write = -1;
  bool open() {
    std::array<int, 2> ends;
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    read = ends[0];
    write = ends[1];
    return true;
  }
  void close() const {
    ::close(read);
    ::close(write);
  }
};

void set_nonblocking(int descriptor) { ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) | O_NONBLOCK); }

// runs in the child, between vfork and exec: system calls only
void become(char* const* argv, const Pipe& input, const Pipe& output, const Pipe& errors, pid_t parent,
            volatile int& failure) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  ::dup2(input.read, 0);
  ::dup2(output.write, 1);
  ::dup2(errors.write, 2);
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (const int signal : {SIGPIPE, SIGINT, SIGTERM, SIGHUP, SIGCHLD, SIGQUIT, SIGXFSZ})
    ::sigaction(signal, &standard, nullptr);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execvp(argv[0], argv);
  failure = errno;
  ::_exit(127);
}

}  // namespace

objdb::Result<Process> spawn(const std::vector<std::string>& argv) {
  std::vector<char*> pointers;
  pointers.reserve(argv.size() + 1);
  for (const std::string& each : argv) pointers.push_back(const_cast<char*>(each.c_str()));
  pointers.push_back(nullptr);

  Pipe input, output, errors;
  if (!input.open() || !output.open() || !errors.open())
    return Error{ErrorKind::limit, argv[0] + " cannot be started: " + std::strerror(errno), 0};

  // no handler of ours may run in the child while it shares our memory
  sigset_t all, before;
  ::sigfillset(&all);
  ::sigprocmask(SIG_SETMASK, &all, &before);
  volatile int failure = 0;
  const pid_t parent = ::getpid();
  const pid_t pid = ::vfork();
  if (pid == 0) become(pointers.data(), input, output, errors, parent, failure);
  const int fork_error = errno;
  ::sigprocmask(SIG_SETMASK, &before, nullptr);

  ::close(input.read);
  ::close(output.write);
  ::close(errors.write);
  if (pid < 0 || failure != 0) {
    ::close(input.write);
    ::close(output.read);
    ::close(errors.read);
    if (pid > 0) ::waitpid(pid, nullptr, 0);
    const int code = pid < 0 ? fork_error : failure;
    const ErrorKind kind = code == ENOENT || code == ENOTDIR ? ErrorKind::unknown : ErrorKind::io;
    return Error{kind, argv[0] + " cannot be started: " + std::strerror(code), 0};
  }
  ::setpgid(pid, pid);
  set_nonblocking(input.write);
  set_nonblocking(output.read);
  set_nonblocking(errors.read);
  const int pidfd = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  return Process{pid, pidfd, input.write, output.read, errors.read};
}

Spare::Spare() {
  for (int& each : held_) each = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
}

Spare::~Spare() {
  for (const int each : held_)
    if (each >= 0) ::close(each);
}

std::string reap(pid_t pid) {
  int status = 0;
  const pid_t got = ::waitpid(pid, &status, WNOHANG);
  if (got == 0) return {};
  if (got < 0) return "gone";
  if (WIFSIGNALED(status)) return "killed " + std::to_string(WTERMSIG(status));
  return "exit status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace channel
