#include "dialog_manager/channel/loop.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

#include "dialog_manager/channel/watch.h"

namespace channel {

Loop::Loop() : impl_(std::make_unique<Impl>()) {}
Loop::~Loop() = default;

void Loop::wait(std::optional<Clock::time_point> deadline) {
  if (!deadline) {
    impl_->wait(nullptr);
    return;
  }
  const auto now = Clock::now();
  const auto rest = *deadline > now ? *deadline - now : Clock::duration::zero();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(rest);
  const timespec limit{seconds.count(), std::chrono::nanoseconds(rest - seconds).count()};
  impl_->wait(&limit);
}

void Loop::poll() {
  const timespec at_once{0, 0};
  impl_->wait(&at_once);
}

void Loop::on_signal(std::initializer_list<int> signals, std::function<void(int)> handler) {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int signal : signals) {
    // an ignored signal, as a shell starts background jobs with, would never arrive
    ::signal(signal, SIG_DFL);
    ::sigaddset(&set, signal);
  }
  ::sigprocmask(SIG_BLOCK, &set, nullptr);
  impl_->signals = ::signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
  impl_->signal_watch.emplace(*impl_, impl_->signals, EPOLLIN, [impl = impl_.get(), handler = std::move(handler)] {
    signalfd_siginfo arrived{};
    while (::read(impl->signals, &arrived, sizeof arrived) == sizeof arrived)
      handler(static_cast<int>(arrived.ssi_signo));
  });
}

// -- Reader

Reader::Reader(Loop& loop, int descriptor, Descriptor kind, std::size_t longest_line)
    : lines_(longest_line),
      descriptor_(descriptor),
      kind_(kind),
      watch_(std::make_unique<Watch>(loop.impl(), descriptor, EPOLLIN, [this] { ready(); })) {
  // our own descriptors are pipes: one that is "always ready" could not be watched
  failed_ = watch_->failed() || (kind == Descriptor::own && watch_->always_ready());
  if (failed_) lines_.close();
}

Reader::~Reader() {
  watch_.reset();
  if (kind_ == Descriptor::own) ::close(descriptor_);
}

void Reader::want() {
  if (watch_->always_ready() && !lines_.closed()) read();
  if (wanted_ || lines_.closed()) return;
  wanted_ = true;
  watch_->on();
  if (watch_->failed()) lines_.close();
}

void Reader::ready() {
  // nobody has asked: it is left waiting, and so is who writes
  if (!wanted_) {
    watch_->off();
    return;
  }
  wanted_ = false;
  read();
}

void Reader::read() {
  constexpr std::size_t chunk = 64 * 1024;
  const ssize_t count = ::read(descriptor_, lines_.room(chunk), chunk);
  if (count > 0)
    lines_.fill(static_cast<std::size_t>(count));
  else if (count == 0 || (errno != EINTR && errno != EAGAIN))
    lines_.close();
}

// -- Writer

namespace {

// a second opening of a pipe has flags of its own, so that a write to it need not be asked for with poll();
// -1: not possible
int opened_again(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISFIFO(status.st_mode)) return -1;
  return ::open(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
}

}  // namespace

Writer::Writer(Loop& loop, int descriptor, Descriptor kind) : descriptor_(descriptor), own_(kind == Descriptor::own) {
  if (const int again = own_ ? -1 : opened_again(descriptor); again >= 0) {
    descriptor_ = again;
    own_ = true;
  }
  struct stat status {};
  socket_ = ::fstat(descriptor_, &status) == 0 && S_ISSOCK(status.st_mode);
  watch_ = std::make_unique<Watch>(loop.impl(), descriptor_, EPOLLOUT, [this] {
    watch_->off();
    waiting_ = false;
    send();
  });
  watch_->off();
}

Writer::~Writer() {
  watch_.reset();
  if (own_) ::close(descriptor_);
}

// one write that does not wait: PIPE_BUF bytes fit whenever poll() says so, whatever flags a shared descriptor has
ssize_t Writer::write_some(std::string_view bytes) const {
  if (own_ || watch_->always_ready()) return ::write(descriptor_, bytes.data(), bytes.size());
  if (socket_) return ::send(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  struct pollfd ready {
    descriptor_, POLLOUT, 0
  };
  if (::poll(&ready, 1, 0) == 0) {
    errno = EAGAIN;
    return -1;
  }
  return ::write(descriptor_, bytes.data(), std::min<std::size_t>(bytes.size(), 4096));
}

void Writer::flush() {
  if (!waiting_ && pending() > 0) send();
}

void Writer::send() {
  while (pending() > 0 && !broken_) {
    const ssize_t count = write_some(std::string_view(buffer_).substr(written_));
    if (count >= 0) {
      written_ += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      waiting_ = true;
      // a reader that is always behind never lets it run empty: what he has read goes all the same
      if (written_ > pending()) {
        buffer_.erase(0, written_);
        written_ = 0;
      }
      watch_->on();
      return;
    } else if (errno != EINTR) {
      broken_ = true;
      failure_ = errno;
    }
  }
  buffer_.clear();
  written_ = 0;
}

void Writer::discard() {
  buffer_.clear();
  written_ = 0;
}

void Writer::drain(std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (pending() > 0 && !broken_ && Clock::now() < deadline) {
    const ssize_t count = write_some(std::string_view(buffer_).substr(written_));
    if (count >= 0) {
      written_ += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      struct pollfd ready {
        descriptor_, POLLOUT, 0
      };
      ::poll(&ready, 1, 10);
    } else if (errno != EINTR) {
      broken_ = true;
      failure_ = errno;
    }
  }
  if (pending() == 0) {
    buffer_.clear();
    written_ = 0;
  }
}

// -- one thing to wait for

ReadyWatch::ReadyWatch(Loop& loop, int descriptor, std::function<void()> handler)
    : watch_(std::make_unique<Watch>(loop.impl(), descriptor, EPOLLIN, [this, handler = std::move(handler)] {
        watch_->off();
        handler();
      })) {
  watch_->off();
}

ReadyWatch::~ReadyWatch() = default;

void ReadyWatch::want() { watch_->on(); }

ExitWatch::ExitWatch(Loop& loop, int pidfd, std::function<void()> handler)
    : pidfd_(pidfd), watch_(std::make_unique<Watch>(loop.impl(), pidfd, EPOLLIN, [this, handler = std::move(handler)] {
        watch_->off();
        handler();
      })) {}

ExitWatch::~ExitWatch() {
  watch_.reset();
  if (pidfd_ >= 0) ::close(pidfd_);
}

}  // namespace channel
