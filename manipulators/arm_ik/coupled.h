#pragma once

#include <span>

#include "manipulators/arm_ik/human_arm.h"
#include "manipulators/arm_ik/solver.h"

namespace arm_ik {

/// The five-input arm: plane, elevation and axial turn of the humerus against the thorax, elbow, forearm. The girdle
/// follows the humerus by the rhythm, inside its limits; the shoulder's joints are what is left between the two. The
/// wrist's place is met exactly, then its orientation as well as the two freedoms left allow (a place alone: as near to
/// the rest posture as they allow).
///
/// Newton's method on: minimize orientation error and departure from rest, subject to the place; joint limits enter as
/// the active rows of each step. Columns of the Jacobian are exact but for the girdle's motion, which is a difference
/// quotient. About 6 us a step. q (11 joints): start, overwritten. `status` reached means the place, and the
/// orientation when one is asked for.
Solution solve_coupled(const HumanArm& arm, const Goal& goal, const SolveOptions& options, std::span<double> q);

}  // namespace arm_ik
