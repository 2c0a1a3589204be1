#include "manipulators/eye_control/aim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/manipulators/eye_control/report.h"

// Row L1 of the acceptance table and the conventions: a person who faces +Z has the right hand at -X.
namespace eye::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(Angles, RightIsMinusXAndUpIsY) {
  EXPECT_LT((fick_direction({0, 0}) - Vector3d(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((fick_direction({pi / 2, 0}) - Vector3d(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((fick_direction({0, pi / 2}) - Vector3d(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((helmholtz_direction({0.3, 0}) - fick_direction({0.3, 0})).norm(), 1e-15);
  EXPECT_LT((helmholtz_direction({0, 0.3}) - fick_direction({0, 0.3})).norm(), 1e-15);
  // azimuth is a rotation about -Y
  const Quaterniond turn(Eigen::AngleAxisd(-0.4, Vector3d::UnitY()));
  EXPECT_LT((turn * Vector3d::UnitZ() - fick_direction({0.4, 0})).norm(), 1e-15);
}

TEST(Angles, GoThereAndBack) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> angle(-1.4, 1.4);
  for (int k = 0; k < 1000; ++k) {
    const Vec2 a{angle(random), angle(random)};
    EXPECT_LT(norm(fick_angles(fick_direction(a)) - a), 1e-14);
    EXPECT_LT(norm(helmholtz_angles(helmholtz_direction(a)) - a), 1e-14);
    EXPECT_LT((fick_rotation(a) * Vector3d::UnitZ() - fick_direction(a)).norm(), 1e-15);
  }
}

TEST(Aims, BothEyesMeetThePoint) {
  // the lines of sight of both eyes pass through the target: Hering's law costs nothing in Helmholtz angles
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> side(-0.2, 0.2), ahead(0.25, 2);
  const double distance = 0.063;
  for (int k = 0; k < 1000; ++k) {
    const Vector3d point(side(random), side(random), ahead(random));
    const Aim aim = aim_at(sight_of_point(point, HeadPose{}), distance, 1.5);
    for (double s : {1.0, -1.0}) {
      const Vector3d line = helmholtz_direction({aim.version.x + s * 0.5 * aim.vergence, aim.version.y});
      const Vector3d from(s * 0.5 * distance, 0, 0);
      EXPECT_LT((point - from).normalized().cross(line).norm(), 1e-14);
    }
  }
}

TEST(Aims, AreLimitedToTheRange) {
  const double range = 50 * deg;
  for (double azimuth : {51.0, 90.0, 160.0, 180.0, -120.0}) {
    const Aim aim = aim_at({fick_direction({azimuth * deg, 0.1}), 0}, 0.063, range);
    EXPECT_TRUE(aim.beyond);
    EXPECT_NEAR(eccentricity(aim.version), range, 1e-12);
    EXPECT_GT(aim.version.x * (azimuth == 180 ? 1 : azimuth), 0);
  }
  EXPECT_FALSE(aim_at({fick_direction({49 * deg, 0}), 0}, 0.063, range).beyond);
  const Vec2 far = within_range({1.2, 0.9}, range);
  EXPECT_NEAR(eccentricity(far), range, 1e-12);
  EXPECT_EQ(within_range({0.3, -0.2}, range), (Vec2{0.3, -0.2}));
}

TEST(Listing, TorsionIsZeroEverywhere) {
  double worst = 0;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-0.9, 0.9);
  for (int k = 0; k < 10000; ++k) {
    const Vector3d d = helmholtz_direction({angle(random), angle(random)});
    const Quaterniond q = listing(d);
    EXPECT_LT((q * Vector3d::UnitZ() - d).norm(), 1e-15 * 4);
    worst = std::max(worst, std::abs(torsion(q)));
  }
  report("L1", "largest torsion %.1e rad (people up to 2 deg)", worst);
  EXPECT_LE(worst, 1e-12);
}

TEST(Listing, AngularVelocityTiltsByHalfTheGazeAngle) {
  // turning up and down while looking aside by a: the axis leaves the frontal plane by exactly a / 2 (people 0.34-0.64
  // of a)
  for (double azimuth : {5.0, 15.0, 30.0}) {
    const double a = azimuth * deg, e = 1e-6;
    const auto at = [&](double up) {
      // same azimuth in Listing's coordinates: a great circle through the point, turned about the half-way axis
      const Quaterniond q0 = listing(fick_direction({a, 0}));
      const Vector3d axis = Quaterniond(Eigen::AngleAxisd(-a / 2, Vector3d::UnitY())) * Vector3d::UnitX();
      return Quaterniond(Eigen::AngleAxisd(-up, axis) * q0);
    };
    // that motion keeps Listing's law, to first order and beyond
    EXPECT_LT(std::abs(at(0.2).z()), 1e-12);
    // and the law's own orientations have that velocity: a central difference over the same directions
    const Quaterniond q1 = listing(at(e) * Vector3d::UnitZ()), q0 = listing(at(-e) * Vector3d::UnitZ());
    const Eigen::AngleAxisd turn(q1 * q0.conjugate());
    const double tilt = std::atan2(std::abs(turn.axis().z()), std::abs(turn.axis().x()));
    report("L1", "%2.0f deg aside: the axis tilts by %.6f of it (people 0.34-0.64)", azimuth, tilt / a);
    EXPECT_NEAR(tilt / a, 0.5, 1e-6);
  }
}

TEST(Listing, ConvergenceTurnsThePlanesOutwards) {
  // with the primary direction turned temporally the eyes extort looking down: left eye negative, right eye positive
  const Vector3d down = fick_direction({0, -20 * deg});
  EXPECT_LT(torsion(listing(down, -5 * deg)), 0);
  EXPECT_GT(torsion(listing(down, 5 * deg)), 0);
  EXPECT_NEAR(torsion(listing(Vector3d::UnitZ(), 5 * deg)), 0, 1e-15);
}

}  // namespace
}  // namespace eye::test
