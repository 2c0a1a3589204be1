#pragma once

#include <span>

#include "manipulators/kinematics/chain.h"

namespace arm_ik {

/// A chain laid out for the solvers: one array a property, padded to whole vectors.
struct Packed {
  static constexpr int capacity = 64;

  explicit Packed(const kinematics::Chain& chain);

  int n = 0;       ///< joints
  int blocks = 0;  ///< vectors of four that hold them
  alignas(64) double offset[capacity];
  alignas(64) double px[capacity], py[capacity], pz[capacity];
  alignas(64) double ca[capacity], sa[capacity];  ///< cosine and sine of alpha
  alignas(64) double turns[capacity];             ///< 1 for a turn, 0 for a slide
  alignas(64) double lower[capacity], upper[capacity], rest[capacity];
  alignas(64) double draw_lower[capacity], draw_upper[capacity];  ///< where starts are drawn: one turn around rest
  alignas(64) double base[16];                                    ///< columns x y z p, four numbers each
  alignas(64) double tool[16];
  bool slides = false;  ///< any slide in the chain
  double length = 0.3;  ///< metres that a radian of orientation error weighs
  double reach = 1;     ///< bound of the distance from the first joint to the tool [m]
};

}  // namespace arm_ik
