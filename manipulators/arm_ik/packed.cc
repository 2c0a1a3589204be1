#include "manipulators/arm_ik/packed.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace arm_ik {

namespace {

void put(double* to, const kinematics::Pose& X) {
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) to[4 * column + row] = X.R(row, column);
  }
  for (int row = 0; row < 3; ++row) to[12 + row] = X.p[row];
  for (int column = 0; column < 4; ++column) to[4 * column + 3] = 0;
}

}  // namespace

Packed::Packed(const kinematics::Chain& chain) : n(chain.size()), blocks((n + 3) / 4) {
  assert(n <= capacity);
  for (double* array : {offset, px, py, pz, sa, lower, upper, rest, draw_lower, draw_upper})
    std::fill_n(array, capacity, 0.0);
  std::fill_n(ca, capacity, 1.0);
  std::fill_n(turns, capacity, 1.0);
  for (int i = 0; i < n; ++i) {
    const kinematics::Joint& joint = chain.joints[i];
    offset[i] = joint.offset;
    px[i] = joint.p.x();
    py[i] = joint.p.y();
    pz[i] = joint.p.z();
    ca[i] = std::cos(joint.alpha);
    sa[i] = std::sin(joint.alpha);
    turns[i] = joint.kind == kinematics::JointKind::turn ? 1 : 0;
    slides = slides || turns[i] == 0;
    lower[i] = joint.lower;
    upper[i] = joint.upper;
    rest[i] = joint.rest;
    // further turns lead to the same places
    const double half = turns[i] == 1 && upper[i] - lower[i] > 2 * M_PI ? M_PI : HUGE_VAL;
    draw_lower[i] = std::max(lower[i], rest[i] - half);
    draw_upper[i] = std::min(upper[i], rest[i] + half);
  }
  put(base, chain.base);
  put(tool, chain.tool);
  reach = std::max(kinematics::reach_bound(chain), 1e-6);
  // measured: any share of the reach from 0.25 to 0.6 does as well; a radian then weighs like what it moves at mid-arm
  length = 0.4 * reach;
}

}  // namespace arm_ik
