#pragma once

#include <time.h>

namespace eye {

/// Processor time of this process, s: for measured fields and charts only.
inline double processor_time() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace eye
