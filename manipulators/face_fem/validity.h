#pragma once

#include <string>
#include <vector>

#include "manipulators/face_fem/stiffness.h"

namespace face {

/// How far a displacement is from what linear elasticity may be asked: small strain, small turn, no element inside
/// out. The limits are where linear and neo-Hookean answers differ by about a twentieth (docs/face.md).
struct Validity {
  double strain = 0;          ///< largest principal strain in magnitude (of the symmetric displacement gradient)
  int strained_element = -1;  ///< index of the hexahedron it is in
  double turn = 0;            ///< largest local rotation, radians
  double volume = 0;          ///< relative change of the whole volume
  int inverted = 0;           ///< hexahedra with a Jacobian that is not positive after moving (points or corners)
  int inverted_element = -1;  ///< the first of them
  double bone_turn = 0;       ///< largest rotation of a bone that the supports prescribe, radians
  int turned_bone = -1;

  static constexpr double strain_limit = 0.5;
  static constexpr double bone_turn_limit = 2 * 3.14159265358979323846 / 180;

  bool linear() const { return inverted == 0 && strain <= strain_limit && bone_turn <= bone_turn_limit; }
  /// One word: "ok" "strain" "bone_turn" "inverted", the gravest.
  const char* word() const;
};

/// Measures `u`. Cost: about that of assembling.
Validity validity_of(const Model& model, const Field& u);

/// A sentence for each limit that is passed.
std::vector<std::string> warnings_of(const Model& model, const Validity& validity);

/// Angle of the rotation that best explains how the supports of a bone move under `shift` (Kabsch), radians; 0 with
/// fewer than three of them.
double bone_turn(const Model& model, const Field& shift, int bone);

}  // namespace face
