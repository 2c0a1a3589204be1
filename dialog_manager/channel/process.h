#pragma once

#include <sys/types.h>

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

/// "exit status 3", "killed 9" ... of a process that has ended; empty while it has not. Reaps it.
std::string reap(pid_t pid);

}  // namespace channel
