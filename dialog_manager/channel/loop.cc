#include "dialog_manager/channel/loop.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "dialog_manager/channel/loop_impl.h"

namespace channel {

namespace asio = boost::asio;
Loop::Loop() : impl_(std::make_unique<Impl>()) {}
Loop::~Loop() = default;

void Loop::wait(std::optional<Clock::time_point> deadline) {
  asio::io_context& context = impl_->context;
  context.restart();
  if (!deadline)
    context.run_one();
  else if (*deadline > Clock::now())
    context.run_one_until(*deadline);
  context.poll();
}

void Loop::poll() {
  impl_->context.restart();
  impl_->context.poll();
}

void Loop::on_signal(std::initializer_list<int> signals, std::function<void(int)> handler) {
  for (const int signal : signals) impl_->signals.add(signal);
  auto again = std::make_shared<std::function<void()>>();
  *again = [this, handler = std::move(handler), weak = std::weak_ptr(again)] {
    impl_->signals.async_wait([handler, keep = weak.lock()](const boost::system::error_code& error, int signal) {
      if (error) return;
      handler(signal);
      (*keep)();
    });
  };
  (*again)();
}

namespace {

using Watched = asio::posix::stream_descriptor;

// Asio sets O_NONBLOCK on what it watches, and a terminal or an inherited pipe shares that flag with other programs.
// So a shared descriptor is watched through an epoll instance of our own, and read and written only when ready.
// Returns -1 for what needs no watching because it is always ready: regular files, /dev/null.
int watched_descriptor(int descriptor, Descriptor kind, std::uint32_t events) {
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) return -1;
  if (kind == Descriptor::own) return ::fcntl(descriptor, F_DUPFD_CLOEXEC, 3);
  const int watch = ::epoll_create1(EPOLL_CLOEXEC);
  struct epoll_event event {};
  event.events = events;
  if (::epoll_ctl(watch, EPOLL_CTL_ADD, descriptor, &event) == 0) return watch;
  ::close(watch);
  return -1;
}

}  // namespace

struct Reader::Impl {
  Impl(Loop& loop, int fd, Descriptor whose) : watched(loop.impl().context), plain(fd), kind(whose) {
    const int watch = watched_descriptor(fd, kind, EPOLLIN);
    always_ready = watch < 0;
    if (!always_ready) watched.assign(watch);
  }
  ~Impl() {
    if (kind == Descriptor::own) ::close(plain);
  }
  Watched watched;
  int plain;
  Descriptor kind;
  bool always_ready;
  bool reading = false;
};

Reader::Reader(Loop& loop, int descriptor, Descriptor kind, std::size_t longest_line)
    : lines_(longest_line), impl_(std::make_shared<Impl>(loop, descriptor, kind)) {
  // our own descriptors are pipes: one that is "always ready" could not be watched
  failed_ = kind == Descriptor::own && impl_->always_ready;
  if (failed_) lines_.close();
}

Reader::~Reader() {
  boost::system::error_code ignored;
  impl_->watched.close(ignored);
}

void Reader::want() {
  if (impl_->reading || lines_.closed()) return;
  if (impl_->always_ready) {
    read();
    return;
  }
  impl_->reading = true;
  impl_->watched.async_wait(Watched::wait_read,
                            [this, impl = std::weak_ptr(impl_)](const boost::system::error_code& error) {
                              // the reader itself may be gone by now
                              const auto alive = impl.lock();
                              if (!alive || error == asio::error::operation_aborted) return;
                              alive->reading = false;
                              read();
                            });
}

void Reader::read() {
  constexpr std::size_t chunk = 64 * 1024;
  char* room = lines_.room(chunk);
  const ssize_t count = ::read(impl_->plain, room, chunk);
  if (count > 0)
    lines_.fill(static_cast<std::size_t>(count));
  else if (count == 0 || (errno != EINTR && errno != EAGAIN))
    lines_.close();
}

struct Writer::Impl {
  Impl(Loop& loop, int fd, Descriptor whose) : watched(loop.impl().context), plain(fd), kind(whose) {
    struct stat status {};
    ::fstat(fd, &status);
    socket = S_ISSOCK(status.st_mode);
    const int watch = watched_descriptor(fd, kind, EPOLLOUT);
    always_ready = watch < 0;
    if (!always_ready) watched.assign(watch);
  }
  ~Impl() {
    if (kind == Descriptor::own) ::close(plain);
  }

  // one write that does not wait: PIPE_BUF bytes fit whenever poll() says so, whatever flags a shared descriptor has
  ssize_t write_some(const char* bytes, std::size_t count) const {
    if (always_ready) return ::write(plain, bytes, count);
    if (socket) return ::send(plain, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (kind == Descriptor::own) return ::write(plain, bytes, count);
    struct pollfd ready {
      plain, POLLOUT, 0
    };
    if (::poll(&ready, 1, 0) == 0) {
      errno = EAGAIN;
      return -1;
    }
    return ::write(plain, bytes, std::min<std::size_t>(count, 4096));
  }

  Watched watched;
  int plain;
  Descriptor kind;
  bool always_ready = false, socket = false;
};

Writer::Writer(Loop& loop, int descriptor, Descriptor kind) : impl_(std::make_shared<Impl>(loop, descriptor, kind)) {}

Writer::~Writer() {
  boost::system::error_code ignored;
  impl_->watched.close(ignored);
}

void Writer::flush() {
  if (!waiting_ && pending() > 0) send();
}

void Writer::send() {
  while (pending() > 0 && !broken_) {
    const ssize_t count = impl_->write_some(buffer_.data() + written_, pending());
    if (count >= 0) {
      written_ += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      waiting_ = true;
      // a reader that is always behind never lets it run empty: what he has read goes all the same
      if (written_ > pending()) {
        buffer_.erase(0, written_);
        written_ = 0;
      }
      // an epoll instance never becomes writable: it becomes readable when what it watches is ready
      const auto readiness = impl_->kind == Descriptor::own ? Watched::wait_write : Watched::wait_read;
      impl_->watched.async_wait(readiness, [this, impl = std::weak_ptr(impl_)](const boost::system::error_code& error) {
        if (!impl.lock() || error == asio::error::operation_aborted) return;
        waiting_ = false;
        send();
      });
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
    const ssize_t count = impl_->write_some(buffer_.data() + written_, pending());
    if (count >= 0) {
      written_ += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      struct pollfd ready {
        impl_->plain, POLLOUT, 0
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

struct ReadyWatch::Impl {
  Impl(Loop& loop, int fd, std::function<void()> call) : watched(loop.impl().context), handler(std::move(call)) {
    const int watch = watched_descriptor(fd, Descriptor::shared, EPOLLIN);
    if (watch >= 0) watched.assign(watch);
  }
  Watched watched;
  std::function<void()> handler;
  bool waiting = false;
};

ReadyWatch::ReadyWatch(Loop& loop, int descriptor, std::function<void()> handler)
    : impl_(std::make_shared<Impl>(loop, descriptor, std::move(handler))) {}

ReadyWatch::~ReadyWatch() {
  boost::system::error_code ignored;
  impl_->watched.close(ignored);
}

void ReadyWatch::want() {
  if (impl_->waiting || !impl_->watched.is_open()) return;
  impl_->waiting = true;
  impl_->watched.async_wait(Watched::wait_read, [impl = std::weak_ptr(impl_)](const boost::system::error_code& error) {
    const auto alive = impl.lock();
    if (!alive || error == asio::error::operation_aborted) return;
    alive->waiting = false;
    alive->handler();
  });
}

struct ExitWatch::Impl {
  Impl(Loop& loop, int pidfd) : watched(loop.impl().context, pidfd) {}
  Watched watched;
};

ExitWatch::ExitWatch(Loop& loop, int pidfd, std::function<void()> handler)
    : impl_(std::make_shared<Impl>(loop, pidfd)) {
  impl_->watched.async_wait(Watched::wait_read, [handler = std::move(handler),
                                                 impl = std::weak_ptr(impl_)](const boost::system::error_code& error) {
    if (!error && impl.lock()) handler();
  });
}

ExitWatch::~ExitWatch() {
  boost::system::error_code ignored;
  impl_->watched.close(ignored);
}

}  // namespace channel
