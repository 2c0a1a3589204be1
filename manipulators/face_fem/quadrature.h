#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "manipulators/face_fem/model.h"

namespace face {

/// How a muscle's force is spread within the sphere at its end.
enum class Weight {
  uniform,  ///< the same everywhere inside
  smooth,   ///< (1 - (d/r)^2)^2, zero at the border
  literal,  ///< 1 inside, 0 outside, never scaled: the total grows with the volume
};

/// How the integral over the sphere is found.
enum class Quadrature {
  octree,   ///< elements that the sphere cuts are divided in reference coordinates; shares are scaled to sum to one
  gauss27,  ///< the 3x3x3 points of each element, hit or missed, over the volume of the whole sphere: misses small
            ///< spheres and doubles others; kept so that this can be shown
};

/// What a sphere gives to the nodes.
struct Spread {
  std::vector<std::pair<int, double>> share;  ///< node and its part of the force, nodes rising
  double total = 0;                           ///< sum of shares: 1, but for gauss27 and literal weight (m3)
  double inside = 0;                          ///< part of the sphere that lies in tissue, 0..1 (by weight)
  Eigen::Vector3d centroid;                   ///< where the shares pull: sum of share x node over total
  int points = 0;                             ///< integration points that hit
};

/// Boxes round the hexahedra, to find those a sphere touches.
class ElementBoxes {
 public:
  explicit ElementBoxes(const Model& model);
  /// Hexahedra whose box meets the sphere, rising.
  std::vector<int> near(const Eigen::Vector3d& centre, double radius) const;

 private:
  std::vector<Eigen::Vector3d> low_, high_;
};

struct SpreadOptions {
  Weight weight = Weight::uniform;
  Quadrature quadrature = Quadrature::octree;
  /// Cells at the border are divided until they are smaller than radius / fineness.
  double fineness = 3;
};

/// Spreads a unit force over the sphere: share_a = integral of w N_a over the tissue inside it. The force of all
/// shares is exact whatever the rule (they are scaled); with the octree the centroid is within 0.01 radius of that of
/// the clipped sphere for every ratio of radius to element size from 0.05 to 3. Cost: about 0.1 ms a sphere.
/// Errors: `muscle` when the radius is not positive and finite or the centre not finite; `missed_sphere` when no tissue
/// (gauss27: no point) is inside.
Result<Spread> spread(const Model& model, const ElementBoxes& boxes, const Eigen::Vector3d& centre, double radius,
                      const SpreadOptions& options = {});

}  // namespace face
