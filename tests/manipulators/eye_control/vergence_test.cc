#include "manipulators/eye_control/vergence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Row G1 of the acceptance table. Human values: latency 160 ms (Rashbass and Westheimer), 40-70 % of convergence and
// 50-100 % of divergence within the saccade (Collewijn 1995).
namespace eye::test {
namespace {

double distance_of(double vergence) { return 0.063 / (2 * std::tan(0.5 * vergence * deg)); }

// vergence (deg) and azimuth step at 0
Course step_course(double from, double to, double azimuth, const Parameters& p) {
  FollowingWorld world;
  const auto nearness = [](double vergence) { return 1 / distance_of(vergence); };
  world.target_track().add(-0.3, {0, 0, nearness(from)});
  world.target_track().add(-0.001, {0, 0, nearness(from)});
  world.target_track().add(0, {azimuth * deg, 0, nearness(to)});
  world.target_track().add(2, {azimuth * deg, 0, nearness(to)});
  return run(world, p);
}

TEST(VergenceStep, StartsAfterItsLatencyAndArrivesWithoutOvershoot) {
  for (const auto& [from, to] : {std::pair{2.0, 6.0}, std::pair{6.0, 2.0}, std::pair{1.0, 10.0}, std::pair{2.0, 2.5}}) {
    const Course r = step_course(from, to, 0, Parameters{});
    EXPECT_NEAR(r.vergence[r.index(0.160)], from, 1e-9);
    EXPECT_GT(std::abs(r.vergence[r.index(0.163)] - from), 1e-4);
    double t90 = 0, overshoot = 0;
    for (size_t k = r.index(0.160); k < r.t.size(); ++k) {
      const double done = (r.vergence[k] - from) / (to - from);
      if (t90 == 0 && done >= 0.9) t90 = r.t[k] - 0.160;
      overshoot = std::max(overshoot, done - 1);
    }
    report("G1", "%.1f to %.1f deg: latency 160 ms, t90 %.0f ms later, overshoot %.2f %%", from, to, 1e3 * t90,
           100 * overshoot);
    EXPECT_GT(t90, 0);
    // below the step that calls the fast component the slow one takes ln(10) / 3 s
    EXPECT_LE(t90, std::abs(to - from) > 0.67 ? 0.6 : 0.8);
    EXPECT_LE(overshoot, 0.05);
  }
}

TEST(VergenceStep, MostOfItHappensInsideASaccade) {
  for (const auto& [from, to, low, high] : {std::tuple{2.0, 8.0, 0.4, 0.7}, std::tuple{8.0, 2.0, 0.5, 1.0}}) {
    const Course r = step_course(from, to, 10, Parameters{});
    double inside = 0;
    for (size_t k = 1; k < r.t.size(); ++k) {
      if (r.mode[k] == Mode::saccade) inside += r.vergence[k] - r.vergence[k - 1];
    }
    const double share = inside / (to - from);
    report("G1", "%.0f to %.0f deg with a 10 deg saccade: %.0f %% inside it (people %.0f-%.0f)", from, to, 100 * share,
           100 * low, 100 * high);
    EXPECT_GE(share, 0.40);
    EXPECT_LE(share, 1.0);
  }
}

TEST(VergenceStep, PlainDelayedFeedbackRingsAtTheAnalyticGain) {
  // x' = -K x(t - T) is marginal at K T = pi / 2: 9.8 /s for 160 ms. Around it the oscillation dies or grows
  for (double rate : {8.8, 10.8}) {
    Parameters p;
    p.vergence_copy_gain = 0;
    p.vergence_rate = rate;
    p.vergence_step = 1;  // no fast component
    p.vergence_limit = 5;
    p.plant_time = 0.001;  // the muscle's lag would add to the delay
    const Course r = step_course(6.0, 6.2, 0, p);
    double early = 0, late = 0;
    for (size_t k = r.index(0.3); k < r.t.size(); ++k) {
      double& largest = r.t[k] < 1.0 ? early : late;
      if (r.t[k] < 1.0 || r.t[k] > 1.3) largest = std::max(largest, std::abs(r.vergence_rate[k]));
    }
    if (rate < 9.8) {
      EXPECT_LT(late, early);
    } else {
      EXPECT_GT(late, early);
    }
  }
}

TEST(VergenceRamp, FollowsSlowApproachSmoothlyAndFastApproachInSteps) {
  // people: smooth below about 2 deg/s, steps above (Hung, Semmlow and Ciuffreda 1986)
  for (double speed : {1.0, 4.0}) {
    FollowingWorld world;
    for (int k = -300; k <= 2000; ++k) {
      const double t = k / 1000.0;
      world.target_track().add(t, {0, 0, 1 / distance_of(2 + (t > 0 ? speed * t : 0))});
    }
    const Course r = run(world, Parameters{});
    double fastest = 0;
    for (double rate : r.vergence_rate) fastest = std::max(fastest, rate);
    if (speed < 2) {
      EXPECT_LT(fastest, 1.5 * speed);
    } else {
      EXPECT_GT(fastest, 1.3 * speed);
    }
    EXPECT_LT(std::abs(r.vergence.back() - (2 + 2 * speed)), 0.3 * speed + 1);
  }
}

}  // namespace
}  // namespace eye::test
