#pragma once

#include <array>
#include <cstddef>

#include "manipulators/eye_control/vec2.h"

namespace eye {

/// One number of each of W figures, side by side. A lane is one figure; the model is written as loops over lanes
/// without branches, so that the compiler does several figures with one instruction. Every lane sees the same
/// operations in the same order whatever W and whatever the registers are, so its bits do not depend on its neighbours.
template <int W>
using Lanes = std::array<double, static_cast<std::size_t>(W)>;

/// The same for a pair of angles.
template <int W>
struct Pairs {
  Lanes<W> x{}, y{};

  Vec2 operator[](std::size_t lane) const { return {x[lane], y[lane]}; }
  void put(std::size_t lane, Vec2 v) { x[lane] = v.x, y[lane] = v.y; }
};

/// Loops are compiled into the function that calls them, and so for the registers which that one is compiled for.
#define EYE_INLINE [[gnu::always_inline]] inline
#define EYE_LAMBDA __attribute__((always_inline))

/// What has decayed so far that it would only slow the processor down (numbers below 2^-1022 are done in microcode).
EYE_INLINE double settled(double x) { return (x < 0 ? -x : x) < 1e-30 ? 0 : x; }

}  // namespace eye
