#pragma once

#include <string>

#include "manipulators/head_ik/neck.h"

namespace head {

/// head_ik --solve TARGETS --out OUT
struct SolveOptions {
  std::string targets, out;  ///< files; an empty `out` or "-" is standard output
  bool paper = false;        ///< the angles of the printed rule, clamped one by one
  double roll = 1;           ///< Donders, for points
};

/// One row of the answer.
struct Answer {
  Zyz asked;                ///< exact angles of the orientation asked for
  Zyz limited;              ///< of the nearest orientation the neck can take
  std::string_view status;  ///< reached limited too_near
};

Answer answer(const Neck& neck, const Eigen::Matrix3d& R, bool paper);

/// Writes alpha_rad,beta_rad,gamma_rad,limited_alpha_rad,limited_beta_rad,limited_gamma_rad,status, a row a target.
/// Exit status: 0, or 1 with one line on standard error.
int solve_command(const Neck& neck, const SolveOptions& options);

}  // namespace head
