#include "dialog_manager/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dialog_manager/screen_text.h"

namespace manager {
namespace {

using namespace std::chrono_literals;

constexpr auto quiet = 1s;
constexpr auto between = 200ms;
constexpr std::size_t bar_length = 24;

void print(int descriptor, const std::string& text) {
  [[maybe_unused]] const ssize_t written = ::write(descriptor, text.data(), text.size());
}

std::string seconds(double value) {
  char text[32];
  const auto whole = static_cast<long>(std::ceil(value));
  constexpr long minute = 60;
  if (whole < 2 * minute)
    std::snprintf(text, sizeof text, "%ld s", whole);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld min", whole / minute, whole % minute);
  return text;
}

}  // namespace

Progress::Progress(int descriptor) : descriptor_(descriptor), terminal_(::isatty(descriptor) != 0) {}

bool Progress::due() {
  const Wall::time_point now = Wall::now();
  if (!working_) {
    working_ = true;
    since_ = now;
    next_ = now + quiet;
    first_share_ = -1;
    return true;
  }
  return now >= next_;
}

void Progress::show(std::optional<double> share, const std::string& what) {
  const Wall::time_point now = Wall::now();
  if (first_share_ < 0) {
    first_share_ = share.value_or(0);
    return;
  }
  const double elapsed = std::chrono::duration<double>(now - since_).count();
  std::string line;
  if (share) {
    const double done = std::clamp(*share, 0.0, 1.0);
    const auto full = static_cast<std::size_t>(done * bar_length);
    char percent[8];
    std::snprintf(percent, sizeof percent, "%3.0f %%", done * 100);
    line = "[" + std::string(full, '#') + std::string(bar_length - full, '.') + "] " + percent;
    if (done > first_share_) line += ", " + seconds(elapsed * (1 - done) / (done - first_share_)) + " left";
    if (!what.empty()) line += ", " + what;
  } else {
    line = what + (what.empty() ? "" : ", ") + seconds(elapsed);
  }
  // one row, or it could not be written over
  const std::size_t columns = terminal_columns(descriptor_);
  while (!line.empty() && width(line) + 1 > columns) line.pop_back();
  print(descriptor_, "\r" + line + "\033[K");
  shown_ = true;
  next_ = now + between;
}

void Progress::clear() {
  if (shown_) print(descriptor_, "\r\033[K");
  shown_ = false;
}

void Progress::rest() {
  clear();
  working_ = false;
}

std::optional<Progress::Wall::time_point> Progress::next() const {
  return working_ && terminal_ ? std::optional(next_) : std::nullopt;
}

}  // namespace manager
