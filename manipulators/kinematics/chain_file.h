#pragma once

#include <string>

#include "manipulators/kinematics/chain.h"
#include "objdb/result.h"

namespace kinematics {

/// Reads a Denavit-Hartenberg table: header `joint,theta0_deg,d_m,a_m,alpha_deg,lower_deg,upper_deg,rest_deg`, one row
/// a joint from the base to the tip; rows named `base` and `tool` carry twelve numbers, a 3x4 transform row by row.
/// Errors: io, syntax, range, limit (more than max_joints), exists (a name twice), each at its line and column.
objdb::Result<Chain> read_dh_chain(const std::string& file);

/// Reads the joints between links `base` and `tip` of a URDF; fixed joints are constant transforms, mimic joints are
/// refused. The path may run up and down the tree. An endless joint gets two turns each way. Rest is the middle of the
/// limits, or 0 where the limits allow it. Errors: io, syntax (not a URDF), unknown (no such link, with the links there
/// are).
objdb::Result<Chain> read_urdf_chain(const std::string& file, const std::string& base, const std::string& tip);

/// The longest chain that the solvers take.
constexpr int max_joints = 64;

}  // namespace kinematics
