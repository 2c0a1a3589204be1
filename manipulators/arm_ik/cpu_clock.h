#pragma once

#include <ctime>

namespace arm_ik {

/// Processor time of this thread [s]: only for columns and fields that say they are measured.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace arm_ik
