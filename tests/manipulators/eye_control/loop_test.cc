#include "manipulators/eye_control/loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Row N1 of the acceptance table, and the two solvers against each other and against analysis.
namespace eye::test {
namespace {

using namespace eye::loop;

double ramp10(double t, bool right) { return (right ? t >= 0 : t > 0) ? 10 * deg : 0; }

// largest difference on the coarser grid, deg/s
double difference(const Solution& fine, const Solution& coarse) {
  double worst = 0;
  const auto every = static_cast<size_t>(std::llround(coarse.step / fine.step));
  for (size_t k = 0; k < coarse.velocity.size(); ++k) {
    worst = std::max(worst, std::abs(coarse.velocity[k] - fine.velocity[k * every]));
  }
  return worst / deg;
}

TEST(Solvers, TwoIndependentOnesAgree) {
  const Parameters p;
  const Solution a = reference(p, ramp10, 0.001, 1.5), b = reference(p, ramp10, 0.002, 1.5);
  const Solution c = solve(Scheme::rk4_hermite, p, ramp10, 1.0 / 16000, 1.5);
  const double self = difference(a, b), cross = difference(c, a);
  report("N1", "collocation on 1 against 2 ms: %.1e deg/s, against RK4 at 1/16 ms: %.1e deg/s", self, cross);
  // AS bends at e = 0 in its second derivative: an interval of length H that holds a crossing errs by about H^3
  EXPECT_LE(self, 1e-7);
  EXPECT_LE(cross, 1e-8);
}

TEST(Solvers, EachHasItsOrder) {
  const Parameters p;
  const Solution exact = reference(p, ramp10, 0.001, 1.5);
  const double orders[] = {1, 1, 2, 2, 2, 4};
  for (Scheme scheme : schemes) {
    const double coarse = difference(exact, solve(scheme, p, ramp10, 0.002, 1.5));
    const double fine = difference(exact, solve(scheme, p, ramp10, 0.001, 1.5));
    const double order = std::log2(coarse / fine), expected = orders[static_cast<size_t>(scheme)];
    report("N1", "%-11s error %.1e deg/s at 1 ms, order %.2f", std::string(word(scheme)).c_str(), fine, order);
    EXPECT_NEAR(order, expected, expected == 4 ? 0.6 : 0.25) << word(scheme);
    if (scheme == Scheme::foh) {
      EXPECT_LE(fine, 2e-4);
      EXPECT_NEAR(order, 2.0, 0.1);
    }
  }
}

TEST(Solvers, TheEyesAreTheFohScheme) {
  // the same ramp through the whole model: the pursuit of it against the reference at its own 1 ms
  Parameters p;
  p.dead_zone = 0.5;
  const Course r = follow(ramp(10, 1.5), p);
  const Solution exact = reference(p, ramp10, 0.001, 1.5);
  double worst = 0;
  for (size_t k = 0; k < exact.velocity.size(); ++k) {
    worst = std::max(worst, std::abs(r.velocity[r.index(0) + k] - exact.velocity[k] / deg));
  }
  report("N1", "the model itself at 1 ms: %.1e deg/s from the reference", worst);
  EXPECT_LE(worst, 2e-4);
}

TEST(Stability, TheCharacteristicEquationMatchesTheMeasuredLoop) {
  for (double milliseconds : {40.0, 79.0, 120.0, -45.0}) {
    Parameters p;
    p.visual_delay += 1e-3 * milliseconds;
    const double gain = marginal_gain(p);
    p.pursuit_gain = 0.98 * gain;
    const double below = measured_growth(p, 0.001, 12);
    p.pursuit_gain = 1.02 * gain;
    const double above = measured_growth(p, 0.001, 12);
    EXPECT_LT(below, 0) << milliseconds;
    EXPECT_GT(above, 0) << milliseconds;
  }
  Parameters none;
  none.copy_gain = 0;
  EXPECT_NEAR(marginal_gain(none), 0.767, 0.002);
}

TEST(Stability, OfTheLocalLoopFollowsTheClosedFormOfTheStep) {
  for (bool trapezoid : {false, true}) {
    for (int steps : {1, 2, 3, 5, 10, 28}) {
      const double product = marginal_local_product(steps, trapezoid), delay = 0.048;
      EXPECT_LT(measured_local_growth(0.97 * product / delay, steps, delay, trapezoid), 0) << steps;
      EXPECT_GT(measured_local_growth(1.03 * product / delay, steps, delay, trapezoid), 0) << steps;
    }
    EXPECT_NEAR(marginal_local_product(100000, trapezoid), pi / 2, 1e-5);
  }
}

TEST(LimitCycle, HasTheSamePeriodInTheIndependentSolver) {
  // 200 ms more retinal delay than the copy knows, after a push; no switch in this solver
  Parameters p;
  p.visual_delay += 0.2;
  const Target push = [](double t, bool) { return t > 0 && t < 0.5 ? 10 * deg : 0.0; };
  const Solution s = reference(p, push, 0.002, 20);
  double first = 0, last = 0;
  int count = -1;
  for (size_t k = 5000; k < s.velocity.size(); ++k) {
    if (!(s.velocity[k - 1] < 0 && s.velocity[k] >= 0)) continue;
    last = (static_cast<double>(k) - s.velocity[k] / (s.velocity[k] - s.velocity[k - 1])) * s.step;
    if (++count == 0) first = last;
  }
  ASSERT_GT(count, 2);
  report("P10", "period at +200 ms by the independent solver: %.1f ms", 1e3 * (last - first) / count);
  EXPECT_NEAR((last - first) / count, 1.0958, 0.01);
}

}  // namespace
}  // namespace eye::test
