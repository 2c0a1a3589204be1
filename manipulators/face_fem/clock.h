#pragma once

#include <ctime>

namespace face {

/// CPU seconds of this thread; only ever told as a cost, never part of a result.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

}  // namespace face
