#include "dialog_manager/restart_policy.h"

#include <cstddef>

namespace manager {
namespace {

using std::chrono::milliseconds;

constexpr int strikes_allowed = 3, garbage_allowed = 2;
constexpr std::size_t starts_allowed = 5;
constexpr auto window = std::chrono::seconds(10);
constexpr milliseconds pauses[strikes_allowed - 1] = {milliseconds(0), milliseconds(50)};

}  // namespace

RestartPolicy::Sentence RestartPolicy::died(Time now, bool garbage) {
  ++strikes_;
  garbage_ = garbage ? garbage_ + 1 : 0;
  while (!starts_.empty() && now - starts_.front() > window) starts_.pop_front();
  if (starts_.size() > starts_allowed || garbage_ >= garbage_allowed) return {Verdict::too_often, now};
  if (strikes_ >= strikes_allowed) return {Verdict::struck_out, now};
  return {Verdict::again, now + pauses[strikes_ - 1]};
}

}  // namespace manager
