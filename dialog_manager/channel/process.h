#pragma once

#include <sys/types.h>

#include <array>
#include <string>
#include <vector>

#include "objdb/result.h"

namespace channel {

/// A child process and our ends of its three pipes. The ends are non-blocking and closed on exec.
struct Process {
  pid_t pid = -1;
  int pidfd = -1;
  int input = -1;   ///< what we write, it reads on 0
  int output = -1;  ///< what it writes on 1
  int errors = -1;  ///< what it writes on 2
};

/// Starts argv[0] (a path, or a name on PATH) in a process group of its own, with default signals and the inherited
/// environment; it is killed when we die. Errors: unknown (no such program), io (it cannot be run).
objdb::Result<Process> spawn(const std::vector<std::string>& argv);

/// Descriptors that are held while a process is started for the first time: its pipes take more for a moment than for
/// its life, and starting it again later must not fail for the want of them.
class Spare {
 public:
  Spare();
  ~Spare();
  Spare(const Spare&) = delete;
  Spare& operator=(const Spare&) = delete;
  /// False: too many are open.
  bool held() const { return held_.back() >= 0; }

 private:
  std::array<int, 4> held_;
};

/// "exit status 3", "killed 9" ... of a process that has ended; empty while it has not. Reaps it.
std::string reap(pid_t pid);

}  // namespace channel
