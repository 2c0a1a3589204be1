#pragma once

#include <map>
#include <string>
#include <vector>

#include "manipulators/face_fem/model.h"
#include "manipulators/face_fem/stiffness.h"

namespace face {

/// A static job: what a file says to solve.
struct Job {
  Model model;
  Field load;                                         ///< newtons, 3 by #nodes
  std::map<std::string, std::vector<int>> node_sets;  ///< by upper-case name, indices
  std::map<std::string, std::vector<int>> element_sets;
  bool has_step = false;  ///< the file had *STEP ... *END STEP
};

/// Reads the static subset of the Abaqus and CalculiX input format:
/// *HEADING, *NODE, *ELEMENT (TYPE C3D8 C3D8I C3D20 C3D20R), *NSET and *ELSET [GENERATE], *MATERIAL, *ELASTIC,
/// *DENSITY, *SOLID SECTION, *BOUNDARY, *STEP, *STATIC, *CLOAD, *DLOAD (P1..P6, GRAV), *END STEP, comments;
/// requests for output are skipped. Keywords and names mean the same in upper and lower case. C3D8 becomes bbar, the
/// project's default; C3D8I wt, C3D20 hex20, C3D20R hex20r.
/// Errors name FILE:LINE:COLUMN: `io`, `syntax`, `truncated`, `unknown`, `element` (mixed kinds), `not_finite`,
/// `material`, `load`.
Result<Job> read_inp(const std::string& path);

/// The same from text; `name` stands for the file in errors.
Result<Job> parse_inp(const std::string& text, const std::string& name);

/// Writes model and nodal loads so that CalculiX solves the same job; bones become node sets, layers element sets.
/// Numbers carry 12 digits: CalculiX keeps only the first 20 characters of one. Error `io`.
Status write_inp(const std::string& path, const Model& model, const Field& load);

}  // namespace face
