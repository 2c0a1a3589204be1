#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

namespace head {

/// A table of things to look at, in the neck's frame.
///   r11,r12,r13,r21,...,r33   orientations, row by row; orthonormal to 1e-4
///   x,y,z                     points [m], seen from the origin
struct Targets {
  std::vector<Eigen::Matrix3d> orientations;  ///< one of the two is empty
  std::vector<Eigen::Vector3d> points;
  int size() const { return static_cast<int>(orientations.size() + points.size()); }
};

/// What is wrong with a file: `FILE:LINE:COLUMN: error KIND sentence`, kinds as in the language.
struct FileError {
  std::string text;
};

/// Reads a CSV table with one of the headers above. Blank lines and carriage returns are tolerated.
std::variant<Targets, FileError> read_targets(const std::string& file);

}  // namespace head
