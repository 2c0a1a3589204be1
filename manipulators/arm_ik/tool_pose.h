#pragma once

#include "manipulators/arm_ik/packed.h"

namespace arm_ik {

/// Tool frame (columns x y z p, four numbers each) of posture q (#joints) by the solvers' own arithmetic.
void tool_pose(const Packed& chain, const double* q, double* frame);

}  // namespace arm_ik
