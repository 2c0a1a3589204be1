#pragma once

#include <string>

namespace arm_ik {

/// The options of `arm_ik --solve`.
struct SolveCommand {
  std::string chain;    ///< .csv (Denavit-Hartenberg), .urdf, or a built-in name: arm11 arm11_left arm11w
  std::string targets;  ///< csv: x,y,z[,qw,qx,qy,qz[,one column a joint]]
  std::string base, tip;
  std::string method = "auto";
  std::string start = "rest";
  std::string out;  ///< empty: standard output
  double position_tolerance = 1e-5;
  double rotation_tolerance = 1e-4;
  double budget = 1e-3;
  unsigned long long seed = 1;
};

/// Solves a file of targets and writes one row for each, in order; says what went wrong on standard error.
/// Returns the exit status: 0, or 1 for bad data (an unreached target is not an error, it is a row). 2: bad usage.
int run(const SolveCommand& command);

}  // namespace arm_ik
