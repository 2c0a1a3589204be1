#include "dialog_manager/channel/watch.h"

#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>

namespace channel {

Watch::Watch(Loop::Impl& loop, int descriptor, std::uint32_t events, std::function<void()> ready)
    : loop_(loop), descriptor_(descriptor), events_(events), ready_(std::move(ready)) {
  on();
}

Watch::~Watch() {
  off();
  loop_.forget(*this);
}

void Watch::on() {
  if (on_ || always_ready_ || failed_) return;
  epoll_event event{};
  event.events = events_;
  event.data.ptr = this;
  on_ = ::epoll_ctl(loop_.epoll, EPOLL_CTL_ADD, descriptor_, &event) == 0;
  always_ready_ = !on_ && errno == EPERM;
  failed_ = !on_ && !always_ready_;
}

void Watch::off() {
  // taken out, not only silenced: a descriptor whose other end is gone is told of whatever one asks for
  if (on_) ::epoll_ctl(loop_.epoll, EPOLL_CTL_DEL, descriptor_, nullptr);
  on_ = false;
}

Loop::Impl::Impl() : epoll(::epoll_create1(EPOLL_CLOEXEC)) {}

Loop::Impl::~Impl() {
  signal_watch.reset();
  if (signals >= 0) ::close(signals);
  ::close(epoll);
}

void Loop::Impl::wait(const timespec* limit) {
  const int count = ::epoll_pwait2(epoll, events.data(), static_cast<int>(events.size()), limit, nullptr);
  happened = {events.data(), static_cast<std::size_t>(count < 0 ? 0 : count)};
  for (const epoll_event& event : happened)
    if (auto* watch = static_cast<Watch*>(event.data.ptr)) watch->ready_();
  happened = {};
}

void Loop::Impl::forget(const Watch& watch) {
  for (epoll_event& event : happened)
    if (event.data.ptr == &watch) event.data.ptr = nullptr;
}

}  // namespace channel
