#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "manipulators/head_ik/neck.h"
#include "objdb/database.h"

namespace head {

/// A neck found in a world.
struct Chain {
  Neck neck;
  std::vector<objdb::ObjectId> joints;  ///< three a level, from bottom to top: flexion, lateral, axial
  Eigen::Matrix3d R_RN;                 ///< of the neck's frame in the root's
  Eigen::Vector3d p_RN;                 ///< [m]
  Eigen::Matrix3d R_NH;                 ///< of the head in the neck's frame, at zero angles
};

/// Walks from `tip` up to `root` and makes levels of the joints between: three a level, named ..._flexion, ..._lateral,
/// ..._axial from below, their axes at right angles through one centre, those of all levels parallel at zero angles, to
/// 1e-6. Nodes between them are constant transforms. Otherwise one sentence that names the joint at fault.
std::variant<Chain, std::string> find_chain(objdb::Database& world, const objdb::Object& root,
                                            const objdb::Object& tip);

/// Everything find_chain looks at but the angles, as numbers: the same numbers, the same chain.
std::vector<double> fingerprint(objdb::Database& world, const objdb::Object& root, const objdb::Object& tip);

}  // namespace head
