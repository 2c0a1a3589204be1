#pragma once

#include <string>
#include <vector>

#include "manipulators/face_fem/quadrature.h"
#include "manipulators/face_fem/stiffness.h"

namespace face {

/// The five parameters of a muscle in the paper's Table 1. Contraction pulls both ends toward each other along the
/// constant direction from origin to insertion: +force on the tissue in the origin's sphere, -force at the insertion.
struct Strand {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();     ///< metres
  Eigen::Vector3d insertion = Eigen::Vector3d::Zero();  ///< metres
  double origin_radius = 0;                             ///< metres; 0: this end is in bone and pulls no tissue
  double insertion_radius = 0;                          ///< metres; likewise
  double force = 0;                                     ///< newtons at activation 1
};

/// Strands that contract together: one for a straight muscle, a chain for a ring.
struct Muscle {
  std::string name;
  std::vector<Strand> strands;
};

/// What a muscle does to the nodes at activation 1.
struct MuscleLoad {
  Field load;           ///< newtons, 3 by #nodes
  double inside = 1;    ///< smallest part of an end's sphere that lies in tissue
  Eigen::Vector3d net;  ///< sum of the forces, newtons; zero when no end is in bone
};

/// The load of a muscle. Errors: `muscle` (no strands, origin at the insertion, both radii 0, a negative radius, a
/// number that is not finite), `missed_sphere`; the sentence names muscle and strand.
Result<MuscleLoad> load_of(const Model& model, const ElementBoxes& boxes, const Muscle& muscle,
                           const SpreadOptions& options = {});

/// A ring or arc of muscle, such as orbicularis: strands from each point to the next (and from the last to the first
/// when closed), all with the same radius and tension. The pulls of neighbours cancel along the ring, so what is left
/// points to its inside, in proportion to the bend.
std::vector<Strand> ring(const std::vector<Eigen::Vector3d>& points, bool closed, double radius, double force);

}  // namespace face
