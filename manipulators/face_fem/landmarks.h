#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "manipulators/face_fem/head.h"

namespace face {

/// What is found on a head before tissue is built: named points and the lines along which the skin is cut.
struct Landmarks {
  std::vector<Landmark> points;  ///< in the order of landmark_names
  std::array<Eyeball, 2> eyes;   ///< left, right
  /// Where the closed lips meet, from the right corner to the left, on the skin, metres; at least 5 points.
  std::vector<Eigen::Vector3d> mouth;
  /// Margins of the lids, from the right end of each eye to its left end; first and last points are the canthi, the
  /// same in both; at least 5 points. Eyes left, right.
  std::array<std::vector<Eigen::Vector3d>, 2> upper_lid, lower_lid;

  const Eigen::Vector3d& at(const std::string& name) const;
};

/// Finds the landmarks of a head that faces +Z: the profile in the middle plane from its turning points, eyes from
/// eyeballs (where a ray from the ball meets no skin outside it the eye is open), mouth corners where the cleft
/// between the lips ends, the rest from relief and proportion. `given` replaces points by name.
/// Errors: `landmark` what was not found and why; `unknown` a name that is not in landmark_names.
Result<Landmarks> find_landmarks(const Head& head, const std::map<std::string, Eigen::Vector3d>& given);

}  // namespace face
