#include "manipulators/head_ik/swing_twist.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace head {
namespace {

TEST(SwingTwist, ComesBackFromItsQuaternion) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), swing(0, 3.1);
  for (int i = 0; i < 10'000; ++i) {
    const double size = i % 10 == 0 ? 1e-12 * swing(random) : swing(random), way = angle(random);
    const SwingTwist given{size * std::cos(way), size * std::sin(way), angle(random)};
    const SwingTwist found = swing_twist(quaternion(given));
    // near a swing of pi the twist is as ill-conditioned as 1 / cos(swing / 2)
    const double tolerance = 2e-15 / std::cos(size / 2);
    EXPECT_NEAR(found.x, given.x, tolerance);
    EXPECT_NEAR(found.z, given.z, tolerance);
    EXPECT_NEAR(std::remainder(found.twist - given.twist, 2 * M_PI), 0, tolerance);
  }
}

TEST(SwingTwist, DoesNotMindTheSignOfTheQuaternion) {
  const Eigen::Quaterniond q = quaternion({0.3, -0.4, 0.5});
  const SwingTwist a = swing_twist(q), b = swing_twist(Eigen::Quaterniond(-q.coeffs()));
  EXPECT_NEAR(a.x, b.x, 1e-15);
  EXPECT_NEAR(a.z, b.z, 1e-15);
  EXPECT_NEAR(a.twist, b.twist, 1e-15);
}

TEST(SwingTwist, OfAHeadUpsideDownHasNoTwist) {
  const SwingTwist found = swing_twist(Eigen::Quaterniond(0, 1, 0, 0));
  EXPECT_EQ(found.twist, 0);
  EXPECT_NEAR(std::hypot(found.x, found.z), M_PI, 1e-15);
}

}  // namespace
}  // namespace head
