#pragma once

namespace eye {

/// Smooth course from 0 at t <= 0 to 1 at t >= 1, at rest at both ends (minimum jerk).
inline double course(double t) { return t <= 0 ? 0 : t >= 1 ? 1 : t * t * t * (10 + t * (6 * t - 15)); }

}  // namespace eye
