#include "dialog_manager/restart_policy.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace manager {
namespace {

using std::chrono::milliseconds;

constexpr int strikes_allowed = 3;
constexpr std::size_t starts_allowed = 5;
constexpr auto window = std::chrono::seconds(10);
constexpr milliseconds pauses[] = {milliseconds(0), milliseconds(50), milliseconds(100), milliseconds(200),
                                   milliseconds(400)};

}  // namespace

std::optional<RestartPolicy::Time> RestartPolicy::died(Time now) {
  ++strikes_;
  while (!starts_.empty() && now - starts_.front() > window) starts_.pop_front();
  if (strikes_ >= strikes_allowed || starts_.size() > starts_allowed) return std::nullopt;
  return now + pauses[std::min(static_cast<std::size_t>(strikes_ - 1), std::size(pauses) - 1)];
}

}  // namespace manager
