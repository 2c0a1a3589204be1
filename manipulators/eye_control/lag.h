#pragma once

#include <cmath>

#include "manipulators/eye_control/vec2.h"

namespace eye {

/// One first-order lag x' = (input - x) / T over a fixed step h, exact for an input that changes linearly within the
/// step (first-order hold): x1 = keep x0 + from i0 + to i1.
struct Lag {
  double time = 0, keep = 0, from = 0, to = 1;

  Lag() = default;
  Lag(double time_constant, double h) : time(time_constant) {
    if (time <= 0) return;
    keep = std::exp(-h / time);
    to = 1 + time / h * std::expm1(-h / time);
    from = 1 - keep - to;
  }

  double advance(double x, double i0, double i1) const { return keep * x + from * i0 + to * i1; }
  Vec2 advance(Vec2 x, Vec2 i0, Vec2 i1) const { return {advance(x.x, i0.x, i1.x), advance(x.y, i0.y, i1.y)}; }
};

}  // namespace eye
