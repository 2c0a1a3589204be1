#pragma once

#include <cstdint>

// Vectors of doubles in the compiler's own extension: plain elementwise arithmetic, so a program gives the same bits
// whether the processor has two, four or eight lanes. Nothing here calls the mathematics library, whose last bits
// differ between processors. Everything is inlined into functions that carry the target attribute.

#define ARM_IK_INLINE [[gnu::always_inline]] inline

namespace arm_ik {

template <int N>
struct Lanes {
  typedef double Real __attribute__((vector_size(8 * N)));
  typedef std::int64_t Mask __attribute__((vector_size(8 * N)));
};
using Real4 = Lanes<4>::Real;
using Mask4 = Lanes<4>::Mask;
using Real8 = Lanes<8>::Real;
using Mask8 = Lanes<8>::Mask;

template <int N>
ARM_IK_INLINE typename Lanes<N>::Real fill(double value) {
  return value - typename Lanes<N>::Real{};
}

template <int N>
ARM_IK_INLINE typename Lanes<N>::Real load(const double* from) {
  typename Lanes<N>::Real out;
  __builtin_memcpy(&out, from, sizeof out);
  return out;
}

template <int N>
ARM_IK_INLINE void store(double* to, typename Lanes<N>::Real value) {
  __builtin_memcpy(to, &value, sizeof value);
}

/// Sine and cosine of N angles, |x| < 1e5 rad, to within 1 unit in the last place. Reduction by multiples of pi/2 in
/// two parts (the first has 33 bits, so that the product is exact), then fdlibm's minimax polynomials.
template <int N>
ARM_IK_INLINE void sine_cosine(typename Lanes<N>::Real x, typename Lanes<N>::Real& sine,
                               typename Lanes<N>::Real& cosine) {
  using Real = typename Lanes<N>::Real;
  using Mask = typename Lanes<N>::Mask;
  // adding 1.5 * 2^52 rounds to the nearest integer, which then stands in the low bits
  constexpr double rounder = 6755399441055744.0;
  const Real shifted = x * 0.63661977236758134308 + rounder;
  const Mask quarter = (Mask)shifted;
  const Real turns = shifted - rounder;
  const Real r = (x - turns * 1.57079632673412561417e+00) - turns * 6.07710050650619224932e-11;
  const Real r2 = r * r;
  Real s = r2 * 1.58969099521155010221e-10 - 2.50507602534068634195e-08;
  s = s * r2 + 2.75573137070700676789e-06;
  s = s * r2 - 1.98412698298579493134e-04;
  s = s * r2 + 8.33333333332248946124e-03;
  s = s * r2 - 1.66666666666666324348e-01;
  s = r + r * (r2 * s);
  Real c = r2 * -1.13596475577881948265e-11 + 2.08757232129817482790e-09;
  c = c * r2 - 2.75573143513906633035e-07;
  c = c * r2 + 2.48015872894767294178e-05;
  c = c * r2 - 1.38888888888741095749e-03;
  c = c * r2 + 4.16666666666666019037e-02;
  c = 1.0 - (0.5 * r2 - r2 * (r2 * c));
  // odd quarters swap, the second bit is the sign
  const Mask odd = (quarter << 63) >> 63;
  const Mask sine_sign = (quarter << 62) & (Mask)fill<N>(-0.0);
  const Mask cosine_sign = ((quarter + 1) << 62) & (Mask)fill<N>(-0.0);
  sine = (Real)((((Mask)c & odd) | ((Mask)s & ~odd)) ^ sine_sign);
  cosine = (Real)((((Mask)s & odd) | ((Mask)c & ~odd)) ^ cosine_sign);
}

template <int N>
ARM_IK_INLINE typename Lanes<N>::Real square_root(typename Lanes<N>::Real x) {
  typename Lanes<N>::Real out;
  for (int lane = 0; lane < N; ++lane) out[lane] = __builtin_sqrt(x[lane]);
  return out;
}

/// Angle of the point (x, y), -pi..pi, to within 2 units in the last place; 0 at the origin. One division, reduction to
/// |ratio| < 0.67, then the rational approximation of the Cephes library.
template <int N>
ARM_IK_INLINE typename Lanes<N>::Real angle_of(typename Lanes<N>::Real y, typename Lanes<N>::Real x) {
  using Real = typename Lanes<N>::Real;
  using Mask = typename Lanes<N>::Mask;
  const Mask sign = (Mask)fill<N>(-0.0);
  const Real ax = (Real)((Mask)x & ~sign), ay = (Real)((Mask)y & ~sign);
  const Mask steep = ay > ax;
  const Real large = steep ? ay : ax, small = steep ? ax : ay;
  // atan(s / l) = pi/4 + atan((s - l) / (s + l))
  const Mask high = small > 0.66 * large;
  const Real upper = high ? small - large : small;
  Real lower = high ? small + large : large;
  lower = lower == 0 ? fill<N>(1.0) : lower;
  const Real r = upper / lower, z = r * r;
  Real p = z * -8.750608600031904122785E-1 - 1.615753718733365076637E1;
  p = p * z - 7.500855792314704667340E1;
  p = p * z - 1.228866684490136173410E2;
  p = p * z - 6.485021904942025371773E1;
  Real q = z + 2.485846490142306297962E1;
  q = q * z + 1.650270098316988542046E2;
  q = q * z + 4.328810604912902668951E2;
  q = q * z + 4.853903996359136964868E2;
  q = q * z + 1.945506571482613964425E2;
  Real angle = r + r * (z * p / q);
  angle += high ? fill<N>(0.78539816339744830962) : fill<N>(0.0);
  angle = steep ? 1.57079632679489661923 - angle : angle;
  angle = x < 0 ? 3.14159265358979323846 - angle : angle;
  return (Real)((Mask)angle | ((Mask)y & sign));
}

/// Processor families with a compiled variant of each kernel.
enum class Isa { portable, avx2, avx512 };

inline Isa best_isa() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return Isa::avx512;
  if (__builtin_cpu_supports("avx2")) return Isa::avx2;
  return Isa::portable;
}

}  // namespace arm_ik
