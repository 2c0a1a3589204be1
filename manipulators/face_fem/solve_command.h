#pragma once

#include <optional>
#include <string>

#include "manipulators/face_fem/element.h"

namespace face {

/// What `face_fem --solve` was asked.
struct SolveRequest {
  std::string model;               ///< an .inp file (inp_file.h)
  std::optional<Element> element;  ///< instead of the one that the file's type stands for
  bool stress = false;
  bool nonlinear = false;  ///< neo-Hookean instead of linear
  std::string out;         ///< CSV; empty: standard output
  std::string vtu;         ///< for ParaView; empty: none
};

/// Solves and writes; a summary goes to standard output when the CSV goes to a file, else to standard error.
/// Returns the exit status: 0, or 1 with one line on standard error.
int run_solve(const SolveRequest& request);

}  // namespace face
