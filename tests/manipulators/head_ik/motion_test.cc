#include "manipulators/head_ik/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "manipulators/head_ik/neck.h"

namespace head {
namespace {

using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

struct Shift {
  double peak_speed = 0, overshoot = 0, last = 0;
};

Shift shift(double amplitude, double h = 1e-3) {
  const Pace pace;
  Motion motion;
  Shift found;
  for (double t = 0; t < 2; t += h) {
    advance(&motion, Vector3d(0, 0, amplitude), pace, h);
    found.peak_speed = std::max(found.peak_speed, motion.speed(pace)[axial]);
    found.overshoot = std::max(found.overshoot, motion.posture()[axial] - amplitude);
    found.last = motion.posture()[axial];
  }
  return found;
}

// the step response of three equal lags has its steepest point at 2 lags, with slope 2 exp(-2) / lag
TEST(Motion, HasAPeakSpeedProportionalToAmplitude) {
  for (const double amplitude : {1.0, 5.0, 10.0})
    EXPECT_NEAR(shift(amplitude * degree).peak_speed / degree, 2 * std::exp(-2) / Pace().lag * amplitude,
                0.01 * 4 * amplitude);
  EXPECT_NEAR(2 * std::exp(-2) / Pace().lag, 4, 0.01);
  EXPECT_LT(shift(130 * degree).peak_speed, Pace().rate);
}

TEST(Motion, ArrivesWithoutOvershoot) {
  for (const double amplitude : {1.0, 40.0, 130.0}) {
    EXPECT_LE(shift(amplitude * degree).overshoot, 1e-15);
    // 2 s less a third for the rate are 24 lags: exp(-24) (1 + 24 + 288) of the way is left
    EXPECT_NEAR(shift(amplitude * degree).last, amplitude * degree, 2e-8 * amplitude * degree);
  }
}

// closed form of three equal lags: 1 - exp(-u) (1 + u + u^2/2)
TEST(Motion, IsTheExactStepResponse) {
  const Pace pace{0.05, 1e9};
  for (const double h : {0.1, 0.01, 0.001}) {
    Motion motion;
    for (int i = 0; i < std::lround(0.2 / h); ++i) advance(&motion, Vector3d(1, -2, 0.5), pace, h);
    const double u = 0.2 / 0.05;
    EXPECT_NEAR(motion.posture()[0], 1 - std::exp(-u) * (1 + u + u * u / 2), 1e-14);
    EXPECT_NEAR(motion.posture()[1], -2 * motion.posture()[0], 1e-14);
  }
}

// the claim of the header: whatever the goals do, the posture stays in their set and keeps to the rate
TEST(Motion, StaysInTheSetAndKeepsTheRateOnAnyPath) {
  const Neck neck = full_neck();
  const Pace pace;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> wide(-3, 3);
  std::uniform_int_distribution<int> wait(1, 300);
  Motion motion;
  Vector3d goal(0, 0, 0), before = motion.posture();
  for (int i = 0, left = 0; i < 200'000; ++i, --left) {
    if (left == 0) goal = neck.clamped(Vector3d(wide(random), wide(random), wide(random))), left = wait(random);
    advance(&motion, goal, pace, 1e-3);
    const Vector3d& now = motion.posture();
    ASSERT_LE(neck.tilt(now), 1 + 1e-12);
    ASSERT_LE(neck.turn(now), 1 + 1e-12);
    ASSERT_LE((now - before).norm(), pace.rate * 1e-3 * (1 + 1e-9));
    before = now;
  }
}

}  // namespace
}  // namespace head
