#pragma once

#include "manipulators/arm_ik/lanes.h"
#include "manipulators/arm_ik/packed.h"

// The inner loops of one inverse kinematics problem: four lanes hold x y z of a vector and a zero.

namespace arm_ik::kernel {

/// The tool's frame: columns and origin, in four lanes each.
struct Frame {
  Real4 x, y, z, p;
};

/// Posture and everything that depends on it.
struct State {
  alignas(64) double q[Packed::capacity];
  alignas(64) Real4 axis[Packed::capacity];    // joint axes
  alignas(64) Real4 origin[Packed::capacity];  // a point on each
  Frame end;
};

/// Columns of the Jacobian (linear, angular times length) and the normal matrix in three blocks of three rows.
struct System {
  alignas(64) Real4 Jv[Packed::capacity], Jw[Packed::capacity];
  Real4 vv[3], wv[3], ww[3];
};

ARM_IK_INLINE Real4 cross(Real4 a, Real4 b) {
  const Mask4 yzx = {1, 2, 0, 3};
  return __builtin_shuffle(a * __builtin_shuffle(b, yzx) - __builtin_shuffle(a, yzx) * b, yzx);
}

ARM_IK_INLINE double sum3(Real4 a) { return (a[0] + a[1]) + a[2]; }

template <bool slides>
ARM_IK_INLINE void forward(const Packed& chain, State& state) {
  alignas(64) double sine[Packed::capacity], cosine[Packed::capacity];
  for (int block = 0; block < chain.blocks; ++block) {
    const int i = 4 * block;
    Real4 angle = load<4>(state.q + i);
    if constexpr (slides) angle *= load<4>(chain.turns + i);
    Real4 s, c;
    sine_cosine<4>(load<4>(chain.offset + i) + angle, s, c);
    store<4>(sine + i, s);
    store<4>(cosine + i, c);
  }
  Real4 x = load<4>(chain.base), y = load<4>(chain.base + 4), z = load<4>(chain.base + 8), p = load<4>(chain.base + 12);
  for (int i = 0; i < chain.n; ++i) {
    state.axis[i] = z;
    state.origin[i] = p;
    // cppcheck-suppress uninitvar ; filled block by block above
    const double s = sine[i], c = cosine[i];
    const Real4 x1 = c * x + s * y;
    const Real4 y1 = c * y - s * x;
    double along = chain.pz[i];
    if constexpr (slides) along += (1 - chain.turns[i]) * state.q[i];
    p += chain.px[i] * x1 + chain.py[i] * y1 + along * z;
    x = x1;
    y = chain.ca[i] * y1 + chain.sa[i] * z;
    z = chain.ca[i] * z - chain.sa[i] * y1;
  }
  const double* t = chain.tool;
  state.end.x = t[0] * x + t[1] * y + t[2] * z;
  state.end.y = t[4] * x + t[5] * y + t[6] * z;
  state.end.z = t[8] * x + t[9] * y + t[10] * z;
  state.end.p = p + (t[12] * x + t[13] * y + t[14] * z);
}

/// Orientation error: twice the vector part of the quaternion that turns `from` into `to` (axis * 2 sin(angle / 2)).
/// Monotonic up to the half turn, no inverse functions, and to first order the rotation vector.
ARM_IK_INLINE Real4 turn_error(const Frame& from, const Frame& to) {
  const Real4 twice_sine = cross(from.x, to.x) + cross(from.y, to.y) + cross(from.z, to.z);
  const double trace = sum3(from.x * to.x + from.y * to.y + from.z * to.z);
  const double twice_one_plus_cosine = trace + 1;  // 4 cos^2(angle / 2)
  // at the half turn the axis is lost; the floor keeps the vector finite and other starts take over
  return twice_sine * (1 / __builtin_sqrt(twice_one_plus_cosine > 1e-12 ? twice_one_plus_cosine : 1e-12));
}

template <bool slides>
ARM_IK_INLINE void linearize(const Packed& chain, const State& state, double length, System& system) {
  for (int i = 0; i < chain.n; ++i) {
    Real4 v = cross(state.axis[i], state.end.p - state.origin[i]);
    Real4 w = state.axis[i] * length;
    if constexpr (slides) {
      v = chain.turns[i] * v + (1 - chain.turns[i]) * state.axis[i];
      w *= chain.turns[i];
    }
    system.Jv[i] = v;
    system.Jw[i] = w;
  }
}

ARM_IK_INLINE void clear(System& system) {
  for (int r = 0; r < 3; ++r) system.vv[r] = system.wv[r] = system.ww[r] = Real4{};
}

/// Adds `weight` times the outer product of column i with itself.
template <bool pose>
ARM_IK_INLINE void add_column(System& system, int i, double weight) {
  const Real4 v = system.Jv[i], w = system.Jw[i], weighted_v = weight * v;
  for (int r = 0; r < 3; ++r) {
    system.vv[r] += v[r] * weighted_v;
    if constexpr (pose) {
      system.wv[r] += w[r] * weighted_v;
      system.ww[r] += (weight * w[r]) * w;
    }
  }
}

/// Solves (A + damping) y = e by LDL^T; rows 0-2 linear, 3-5 angular. A is positive semidefinite, damping > 0.
template <bool pose>
ARM_IK_INLINE void solve(const System& system, double damping, Real4 ev, Real4 ew, Real4& yv, Real4& yw) {
  constexpr int m = pose ? 6 : 3;
  double a[6][6], y[6];
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c <= r; ++c) a[r][c] = system.vv[r][c];
    y[r] = ev[r];
    if constexpr (pose) {
      for (int c = 0; c < 3; ++c) a[3 + r][c] = system.wv[r][c];
      for (int c = 0; c <= r; ++c) a[3 + r][3 + c] = system.ww[r][c];
      y[3 + r] = ew[r];
    }
  }
  double inverse[6];
#pragma GCC unroll 6
  for (int k = 0; k < m; ++k) {
    inverse[k] = 1 / (a[k][k] + damping);
#pragma GCC unroll 6
    for (int r = k + 1; r < m; ++r) {
      const double l = a[r][k] * inverse[k];
#pragma GCC unroll 6
      for (int c = k + 1; c <= r; ++c) a[r][c] -= l * a[c][k];
      y[r] -= l * y[k];
    }
  }
#pragma GCC unroll 6
  for (int k = m - 1; k >= 0; --k) {
    double sum = y[k];
#pragma GCC unroll 6
    for (int r = k + 1; r < m; ++r) sum -= a[r][k] * y[r];
    y[k] = sum * inverse[k];
  }
  yv = Real4{y[0], y[1], y[2], 0};
  if constexpr (pose) yw = Real4{y[3], y[4], y[5], 0};
}

}  // namespace arm_ik::kernel
