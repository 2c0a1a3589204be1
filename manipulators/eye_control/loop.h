#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "manipulators/eye_control/parameters.h"

/// One axis of the pursuit loop as a delay differential equation of its own, for measuring how it is best integrated
/// and where it is stable. No switch, no predictor; the eyes themselves run on `Pursuit`.
namespace eye::loop {

/// Target velocity at time t, rad/s; `right`: the limit from the right where it jumps.
using Target = std::function<double(double t, bool right)>;

/// Integration schemes with the interpolation of the past that they use.
enum class Scheme { euler, zoh, heun, foh, rk4_linear, rk4_hermite };
inline constexpr Scheme schemes[] = {Scheme::euler, Scheme::zoh,        Scheme::heun,
                                     Scheme::foh,   Scheme::rk4_linear, Scheme::rk4_hermite};
std::string_view word(Scheme scheme);

/// A solution on an even grid: eye velocity v (rad/s) at k * step, k = 0 ... n.
struct Solution {
  double step = 0;
  std::vector<double> velocity;
};

/// From rest at t = 0 to `end` with a fixed step, which must not exceed any delay. `linear` leaves AS and VS out.
Solution solve(Scheme scheme, const Parameters& p, const Target& target, double step, double end, bool linear = false);

/// The same, independent of all of `solve`: method of steps by spectral collocation. Within an interval every delayed
/// term is known, so c is an integral (Gauss quadrature matrix) and v, w solve a linear system; nodes lie inside the
/// intervals, so no one-sided limit is ever asked for. All delays and breakpoints of the target must be multiples of
/// `interval`, then the past is met at its own nodes and nothing is interpolated. Error near 1e-13 where the solution
/// is smooth, 1e-9 where AS passes its kink of second order at e = 0. Result every `interval`.
Solution reference(const Parameters& p, const Target& target, double interval, double end);

/// Open loop G(s) of the linear pursuit loop, so that 1 + P G(s) = 0 is its characteristic equation:
/// F(s) (exp(-s tv) - g exp(-s tv')), F = K exp(-s to) / ((s + K exp(-s tm)) (1 + s T2)). The copy's other beliefs are
/// taken as true.
std::complex<double> open_loop(std::complex<double> s, const Parameters& p);

/// Smallest pursuit gain at which the linear loop oscillates for ever, from the phase crossings of G on the imaginary
/// axis up to 20 Hz; infinite if none.
double marginal_gain(const Parameters& p);

/// Largest K tm of the local loop c' = -K c(t - tm) that is stable with a step that divides the delay `steps` times.
/// Euler: 2 steps sin(pi / (2 (2 steps + 1))), below pi / 2. Trapezoid: 2 steps tan(pi / (4 steps)), above it. Both
/// tend to pi / 2, the bound of the equation itself.
double marginal_local_product(int steps, bool trapezoid);

/// Growth rate of an oscillation of the linear loop after a short push, 1/s, as measured with FOH.
double measured_growth(const Parameters& p, double step, double length);

/// The same for the local loop alone.
double measured_local_growth(double gain, int steps, double delay, bool trapezoid);

}  // namespace eye::loop
