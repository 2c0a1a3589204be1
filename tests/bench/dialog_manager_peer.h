#pragma once

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

extern char** environ;

/// Other processes as a benchmark sees them: two descriptors, a processor, and what the kernel counts of them.
namespace bench {

[[noreturn]] inline void give_up(const std::string& what) {
  std::fprintf(stderr, "bench: %s: %s\n", what.c_str(), std::strerror(errno));
  std::exit(1);
}

/// This process, and the children it makes meanwhile, on one processor.
class Pinned {
 public:
  Pinned() {
    sched_getaffinity(0, sizeof before_, &before_);
    // the last one: the first serves the interrupts
    int last = 0;
    for (int i = 0; i < CPU_SETSIZE; ++i)
      if (CPU_ISSET(i, &before_)) last = i;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(last, &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~Pinned() { sched_setaffinity(0, sizeof before_, &before_); }
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

 private:
  cpu_set_t before_;
};

/// Two ends that lines are written to and read from; blocking, as the plainest client is.
class Talk {
 public:
  Talk(int in, int out) : in_(in), out_(out), buffer_(1 << 20) {}
  ~Talk() { close(); }
  Talk(const Talk&) = delete;
  Talk& operator=(const Talk&) = delete;

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t count = ::write(out_, text.data(), text.size());
      if (count < 0 && errno != EINTR) give_up("write");
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  /// Reads until so many lines have ended; nothing may follow them. The last bytes that were read.
  std::string_view read_lines(std::size_t lines) {
    std::size_t used = 0;
    while (lines > 0) {
      if (used == buffer_.size()) used = 0;
      const ssize_t count = ::read(in_, buffer_.data() + used, buffer_.size() - used);
      if (count <= 0) give_up("read");
      const char* from = buffer_.data() + used;
      const char* end = from + count;
      while (lines > 0) {
        from = static_cast<const char*>(std::memchr(from, '\n', static_cast<std::size_t>(end - from)));
        if (from == nullptr) break;
        ++from;
        --lines;
      }
      used += static_cast<std::size_t>(count);
    }
    return {buffer_.data(), used};
  }
  /// Reads until a line begins with `head`.
  void read_until(std::string_view head) {
    std::string line;
    char c = 0;
    while (true) {
      if (::read(in_, &c, 1) != 1) give_up("read, waiting for " + std::string(head));
      if (c != '\n') {
        line += c;
        continue;
      }
      if (line.starts_with(head)) return;
      line.clear();
    }
  }
  void close_input() {
    if (out_ >= 0 && out_ != in_) ::close(out_);
    out_ = -1;
  }
  void close() {
    close_input();
    if (in_ >= 0) ::close(in_);
    in_ = -1;
  }
  int in() const { return in_; }
  int out() const { return out_; }

 private:
  int in_, out_;
  std::vector<char> buffer_;
};

/// A child process on two pipes: a program, or a function of this one.
class Program : public Talk {
 public:
  explicit Program(const std::vector<std::string>& argv) : Program(pipes(), argv, nullptr) {}
  explicit Program(const std::function<void()>& body) : Program(pipes(), {}, &body) {}
  ~Program() { end(); }

  pid_t pid() const { return pid_; }
  /// Closes its input and waits. The exit status, -1 after a signal.
  int end() {
    if (pid_ <= 0) return 0;
    close();
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void kill() const { ::kill(pid_, SIGKILL); }

  /// Seconds that it has spent on a processor.
  double cpu_seconds() const {
    double nanoseconds = 0;
    std::ifstream("/proc/" + std::to_string(pid_) + "/schedstat") >> nanoseconds;
    return nanoseconds * 1e-9;
  }
  /// Bytes of memory it holds (VmRSS) or has held at the most (VmHWM).
  double memory(std::string_view which) const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/status");
    for (std::string word; file >> word;)
      if (word == std::string(which) + ":") {
        double kilobytes = 0;
        file >> kilobytes;
        return kilobytes * 1024;
      }
    return 0;
  }
  /// Its children.
  std::vector<pid_t> children() const {
    std::vector<pid_t> out;
    const std::string id = std::to_string(pid_);
    std::ifstream file("/proc/" + id + "/task/" + id + "/children");
    for (pid_t child = 0; file >> child;) out.push_back(child);
    return out;
  }

 private:
  struct Pipes {
    int to[2], from[2];
  };
  static Pipes pipes() {
    Pipes out{};
    if (::pipe2(out.to, O_CLOEXEC) != 0 || ::pipe2(out.from, O_CLOEXEC) != 0) give_up("pipe");
    return out;
  }
  Program(const Pipes& ends, const std::vector<std::string>& argv, const std::function<void()>* body)
      : Talk(ends.from[0], ends.to[1]) {
    if (body != nullptr) {
      pid_ = ::fork();
      if (pid_ == 0) {
        ::dup2(ends.to[0], 0);
        ::dup2(ends.from[1], 1);
        // the ends of others would never be seen to close
        ::close_range(3, ~0u, 0);
        (*body)();
        ::_exit(0);
      }
    } else {
      std::vector<char*> pointers;
      for (const std::string& each : argv) pointers.push_back(const_cast<char*>(each.c_str()));
      pointers.push_back(nullptr);
      posix_spawn_file_actions_t actions;
      posix_spawn_file_actions_init(&actions);
      posix_spawn_file_actions_adddup2(&actions, ends.to[0], 0);
      posix_spawn_file_actions_adddup2(&actions, ends.from[1], 1);
      errno = ::posix_spawnp(&pid_, pointers[0], &actions, nullptr, pointers.data(), environ);
      posix_spawn_file_actions_destroy(&actions);
      if (errno != 0) give_up(argv[0]);
    }
    ::close(ends.to[0]);
    ::close(ends.from[1]);
  }

  pid_t pid_ = 0;
};

/// A connection to a UNIX socket, when somebody listens within a second; -1 otherwise.
inline int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  for (int i = 0; i < 1000; ++i) {
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return descriptor;
    ::close(descriptor);
    ::usleep(1000);
  }
  return -1;
}

}  // namespace bench
