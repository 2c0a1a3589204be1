#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Rows P1 to P10 of the acceptance table. Targets and bands come from Robinson, Gordon and Gordon (1986, abstract)
// where people are named, and from the analysis of the loop (Lambert W and characteristic roots) for the thresholds.
namespace eye::test {
namespace {

// pursuit alone: no saccade hides it, and the eye may turn as far as a fast ramp needs
Parameters pursuit_alone() {
  Parameters p;
  p.dead_zone = 0.5;
  p.range = 1.2;
  p.eye_range = 1.3;
  return p;
}

double first_reaching(const Course& r, double velocity) {
  for (size_t k = 1; k < r.t.size(); ++k) {
    if (r.velocity[k] < velocity) continue;
    const double part = (velocity - r.velocity[k - 1]) / (r.velocity[k] - r.velocity[k - 1]);
    return r.t[k - 1] + part * (r.t[k] - r.t[k - 1]);
  }
  return NAN;
}

TEST(PursuitOnset, FirstMotionComesAfterTheSumOfTheDelays) {
  for (double speed : {5.0, 10.0, 20.0, 40.0}) {
    const Course r = follow(ramp(speed, 0.6), pursuit_alone());
    const size_t still = r.index(0.100), moves = r.index(0.101);
    EXPECT_EQ(r.velocity[still], 0) << speed;
    EXPECT_GT(r.velocity[moves], 0) << speed;
    const double t10 = first_reaching(r, 0.1 * 0.95 * speed), t40 = first_reaching(r, 0.4 * 0.95 * speed);
    const double onset = 1e3 * (t10 - (t40 - t10) / 3);
    report("P1", "%2.0f deg/s: first motion 100 ms, extrapolated onset %.1f ms (people 100)", speed, onset);
    EXPECT_GE(onset, 100);
    EXPECT_LE(onset, 125);
  }
}

TEST(PursuitOnset, RingsAsPeopleDo) {
  for (double speed : {5.0, 10.0, 20.0}) {
    const Course r = follow(ramp(speed, 1.5), pursuit_alone());
    const Extremes e = extremes(r.t, r.velocity, 0.12, 1e-5 * speed);
    ASSERT_GE(e.time.size(), 3u);
    const double frequency = 1 / (e.time[2] - e.time[0]);
    report("P2", "%2.0f deg/s: rings at %.2f Hz (people 3.8)", speed, frequency);
    EXPECT_NEAR(frequency, 3.8, 0.2);
  }
}

// mean over whole rings long after the onset
double steady_gain(double speed, double gain) {
  Parameters p = pursuit_alone();
  p.pursuit_gain = gain;
  const double length = std::min(2.0, 110 / speed);
  FollowingWorld world =
      world_of({{-0.2, -0.5 * speed * length}, {0, -0.5 * speed * length}, {length, 0.5 * speed * length}});
  const Course r = run(world, p);
  return r.velocity.back() / speed;
}

TEST(PursuitGain, SteadyStateIsTheCommandGainUpToTheSpeedLimit) {
  for (double speed : {5.0, 10.0, 20.0, 30.0, 60.0, 90.0}) {
    const double gain = steady_gain(speed, 0.95), more = steady_gain(speed, 1.05);
    report("P3", "%2.0f deg/s: gain %.4f with P = 0.95 (people 0.95), %.4f with P = 1.05", speed, gain, more);
    EXPECT_NEAR(gain, 0.95, 0.005);
    // above 1: impossible for plain negative feedback, and people do it. Near VS / 1.05 the limit is met first
    if (speed < 90) {
      EXPECT_NEAR(more, 1.05, 0.005);
    }
  }
}

TEST(PursuitGain, SaturatesAtTheSpeedLimit) {
  const double velocity = 120 * steady_gain(120, 0.95);
  report("P6", "120 deg/s: eye %.2f deg/s (VS * P = 95)", velocity);
  EXPECT_NEAR(velocity, 95, 1);
}

double overshoot(double speed, Method method) {
  Parameters p = pursuit_alone();
  p.method = method;
  const Course r = follow(ramp(speed, 1.0), p);
  const double peak = *std::max_element(r.velocity.begin(), r.velocity.end());
  return 100 * (peak / (0.95 * speed) - 1);
}

TEST(PursuitOnset, OvershootFallsWithSpeedThroughTheAccelerationLimit) {
  const double speeds[] = {5, 10, 20, 30}, expected[] = {14, 9, 5, 3};
  double before = 100;
  for (int k = 0; k < 4; ++k) {
    const double full = overshoot(speeds[k], Method::full), linear = overshoot(speeds[k], Method::linear);
    report("P4", "%2.0f deg/s: overshoot %.1f %% (analysis %.0f), linear %.1f %% (23)", speeds[k], full, expected[k],
           linear);
    EXPECT_NEAR(full, expected[k], 2);
    EXPECT_LT(full, before);
    // the linear loop of K tm = 0.75 overshoots by 23 % at every speed
    EXPECT_NEAR(linear, 23, 0.2);
    before = full;
  }
}

TEST(PursuitOnset, InitialAccelerationFollowsThePeopleOfDeBrouwer) {
  const double speeds[] = {5, 10, 20, 30, 40}, people[] = {34, 63, 100, 121, 124};
  for (int k = 0; k < 5; ++k) {
    const Course r = follow(ramp(speeds[k], 0.5), pursuit_alone());
    const double acceleration = r.velocity[r.index(0.180)] / 0.1;
    report("P5",
           "%2.0f deg/s: v(180 ms) / 0.1 s = %.0f deg/s2 (people %.0f; their window is read as 80-180 ms after "
           "target onset)",
           speeds[k], acceleration, people[k]);
    EXPECT_NEAR(acceleration, people[k], 0.15 * people[k]);
  }
}

TEST(PursuitOffset, DecaysExponentiallyWithoutRinging) {
  for (double speed : {5.0, 10.0, 20.0}) {
    const Course r = follow({{-0.2, 0}, {0, 0}, {1, speed}, {3, speed}}, pursuit_alone());
    const double stop = r.velocity[r.index(1.1)];
    double t80 = 0, t20 = 0, least = stop;
    for (size_t k = r.index(1.1); k < r.t.size(); ++k) {
      if (t80 == 0 && r.velocity[k] <= 0.8 * stop) t80 = r.t[k];
      if (t20 == 0 && r.velocity[k] <= 0.2 * stop) t20 = r.t[k];
      least = std::min(least, r.velocity[k]);
    }
    const double tau = 1e3 * (t20 - t80) / std::log(4);
    report("P7", "%2.0f deg/s: offset time constant %.1f ms (people 90), undershoot %.2f %%", speed, tau,
           -100 * least / speed);
    EXPECT_NEAR(tau, 90, 5);
    EXPECT_GT(least, -0.01 * speed);
    // and rests: what its own stopping makes slip does not set the eye off again
    EXPECT_LT(std::abs(r.velocity.back()), 1e-6 * speed);
    EXPECT_LT(std::abs(r.position.back() - r.position[r.index(2.5)]), 1e-6);
    EXPECT_EQ(r.mode.back(), Mode::fixation);
  }
}

// growth of an oscillation, 1/s, and its frequency, Hz, after a short push; linear loop
struct Growth {
  double rate, frequency;
};

Growth growth(Parameters p, double length) {
  p.method = Method::linear;
  p.dead_zone = 0.5;
  const Course r = follow({{-0.2, 0}, {0, 0}, {0.06, 0.6}, {length, 0.6}}, p);
  const Extremes e = extremes(r.t, r.velocity, 0.5 * length, 0);
  double early = 0, late = 0;
  for (size_t k = r.index(0.5 * length); k < r.t.size(); ++k) {
    double& largest = r.t[k] < 0.75 * length ? early : late;
    largest = std::max(largest, std::abs(r.velocity[k]));
  }
  return {std::log(late / early) / (0.25 * length),
          0.5 * static_cast<double>(e.time.size() - 1) / (e.time.back() - e.time.front())};
}

// where the growth rate changes sign between two values of a parameter
template <class Make>
double threshold(Make&& make, double from, double to, double length) {
  const double f = growth(make(from), length).rate, t = growth(make(to), length).rate;
  EXPECT_LT(f * t, 0);
  return from + (to - from) * f / (f - t);
}

TEST(PursuitStability, WithoutTheCopyTheLoopIsMarginalAtThreeQuarters) {
  const auto with_gain = [](double gain) {
    Parameters p;
    p.copy_gain = 0;
    p.pursuit_gain = gain;
    return p;
  };
  const double marginal = threshold(with_gain, 0.755, 0.780, 8);
  const double frequency = growth(with_gain(0.767), 8).frequency;
  report("P8", "without efference copy: marginal at P = %.4f, %.2f Hz (analysis 0.767, 3.3)", marginal, frequency);
  EXPECT_NEAR(marginal, 0.767, 0.02 * 0.767);
  EXPECT_NEAR(frequency, 3.3, 0.1);
  Parameters healthy;
  EXPECT_LT(growth(healthy, 2).rate, -1);
}

TEST(PursuitStability, DelayMismatchIsToleratedAsAnalysed) {
  const auto with_delay = [](double milliseconds) {
    Parameters p;
    p.visual_delay = 0.070 + 1e-3 * milliseconds;
    return p;
  };
  const double longer = threshold(with_delay, 77, 82, 12), shorter = threshold(with_delay, -43, -47, 12);
  report("P9", "visual delay off by %+.1f or %+.1f ms is marginal (analysis +79, -45)", longer, shorter);
  EXPECT_NEAR(longer, 79, 3);
  EXPECT_NEAR(shorter, -45, 3);
}

// period of the limit cycle with a retinal delay the copy does not know, s
double cycle_period(double added) {
  Parameters p = pursuit_alone();
  p.visual_delay += added;
  p.predictor = 0;
  const Course r = follow({{-0.2, 0}, {0, 0}, {0.5, 5}, {25, 5}}, p);
  double first = 0, last = 0;
  int count = -1;
  for (size_t k = r.index(12); k < r.t.size(); ++k) {
    if (!(r.velocity[k - 1] < 0 && r.velocity[k] >= 0)) continue;
    last = r.t[k] - 1e-3 * r.velocity[k] / (r.velocity[k] - r.velocity[k - 1]);
    if (++count == 0) first = last;
  }
  return count > 0 ? (last - first) / count : 0;
}

// The same period without integrating anything: harmonic balance. AS is odd and soft, so it passes the first harmonic
// of what it is given with a real gain below 1, and the loop around it,
//   L(s) = -K (P e^{-s to} (e^{-s (tv + d)} - e^{-s tv}) / (1 + s T2) + e^{-s tm}) / s,
// must be real and above 1 at the frequency of the cycle, whatever the limit is. Lowest such frequency; s.
double balanced_period(double added) {
  const Parameters p;
  const auto loop = [&](double w) {
    const std::complex<double> s(0, w);
    const auto outer = p.pursuit_gain * std::exp(-s * p.motor_delay) / (1.0 + s * p.plant_time) *
                       (std::exp(-s * (p.visual_delay + added)) - std::exp(-s * p.visual_delay));
    return -p.local_gain * (outer + std::exp(-s * p.local_delay)) / s;
  };
  double before = 0.5;
  while (!(loop(before).imag() * loop(before + 0.001).imag() < 0 && loop(before).real() > 1)) before += 0.001;
  return 2 * pi / (before + 0.0005);
}

TEST(PursuitStability, AddedDelayMakesLimitCycles) {
  const double at200 = cycle_period(0.2), at300 = cycle_period(0.3), at400 = cycle_period(0.4);
  const double slope = (at400 - at200) / 0.2, intercept = at200 - 0.2 * slope;
  const double balanced = (balanced_period(0.4) - balanced_period(0.2)) / 0.2;
  report("P10",
         "added delay: period = %.2f delay + %.0f ms, harmonic balance %.2f delay + %.0f ms (Robinson's model 3.4, "
         "479; Lisberger's 2.7, 554; people 1.41-1.6, 212-306)",
         slope, 1e3 * intercept, balanced, 1e3 * (balanced_period(0.2) - 0.2 * balanced));
  // the harmonics that the balance leaves out shorten the period, by less than they carry
  EXPECT_NEAR(at200, balanced_period(0.2), 0.015 * at200);
  EXPECT_NEAR(at300, balanced_period(0.3), 0.015 * at300);
  EXPECT_NEAR(at400, balanced_period(0.4), 0.015 * at400);
}

TEST(PursuitStability, TheLimitCycleScalesWithTheAccelerationLimit) {
  // without the limit of speed the equations are homogeneous in all velocities and the limit of acceleration: another
  // limit makes the same cycle of another size
  const auto cycle = [](double limit) {
    Parameters p = pursuit_alone();
    p.visual_delay += 0.2;
    p.predictor = 0;
    p.offset_switch = 0;
    p.acceleration_limit = limit * deg;
    const Course r = follow({{-0.2, 0}, {0, 0}, {0.5, limit / 60}, {8, limit / 60}}, p);
    return *std::max_element(r.velocity.begin(), r.velocity.end()) / limit;
  };
  EXPECT_NEAR(cycle(300), 25.3 / 300, 0.002);
  EXPECT_NEAR(cycle(150), cycle(300), 1e-9);
}

TEST(PursuitState, TheVisualLagVariantIsSlowToStartAndSteadyInTheEnd) {
  // 50 ms of delay and 20 ms of lag instead of 70 ms: the first motion comes at 80 ms, so it is not the default
  Parameters p = pursuit_alone();
  p.visual_delay = p.copy_visual_delay = 0.050;
  p.visual_lag = 0.020;
  const Course r = follow(ramp(10, 1.5), p);
  EXPECT_EQ(r.velocity[r.index(0.080)], 0);
  // the lagged estimate first has to pass the threshold of pursuit
  EXPECT_GT(r.velocity[r.index(0.085)], 0);
  EXPECT_NEAR(r.velocity.back() / 10, 0.95, 0.005);
}

}  // namespace
}  // namespace eye::test
