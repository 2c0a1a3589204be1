#include "manipulators/head_ik/gaze.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace head {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

TEST(Gaze, ComesBackFromItsDirection) {
  for (double yaw = -3.1; yaw < 3.14; yaw += 0.37)
    for (double pitch = -1.5; pitch < 1.57; pitch += 0.31) {
      const Gaze found = gaze(direction({yaw, pitch}));
      // asin-like loss towards the zenith is avoided by atan2
      EXPECT_NEAR(found.yaw, yaw, 1e-14);
      EXPECT_NEAR(found.pitch, pitch, 1e-15);
    }
  EXPECT_GT(direction({0.1, 0}).x(), 0) << "positive yaw is to the left";
  EXPECT_EQ(gaze({0, 1, 0}).yaw, 0);
  EXPECT_EQ(gaze({0, -3, 0}).pitch, -M_PI / 2);
}

TEST(Donders, LooksWhereItShouldWithEveryRoll) {
  for (const double roll : {0.0, 0.5, 1.0})
    for (double yaw = -3; yaw < 3.1; yaw += 0.4)
      for (double pitch = -1.5; pitch < 1.5; pitch += 0.3) {
        const Matrix3d R = donders({yaw, pitch}, roll);
        EXPECT_LE((R.col(2) - direction({yaw, pitch})).norm(), 1e-15);
        EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).norm(), 2e-15);
      }
}

// Fick: the line through the ears stays level. Listing: the rotation vector has no component along the look axis.
TEST(Donders, KeepsFicksAndListingsLaw) {
  for (double yaw = -1; yaw <= 1; yaw += 0.25)
    for (double pitch = -1; pitch <= 1; pitch += 0.25) {
      EXPECT_NEAR(donders({yaw, pitch}, 1)(1, 0), 0, 1e-15);
      EXPECT_NEAR(Eigen::Quaterniond(donders({yaw, pitch}, 0)).z(), 0, 1e-15);
    }
}

// the closed form of the roll between the two: tan(torsion / 2) = tan(yaw / 2) tan(pitch / 2), here for 40 and 30
// degrees
TEST(Donders, RollsByTheKnownAngle) {
  const Matrix3d between = donders({40 * degree, 30 * degree}, 0).transpose() * donders({40 * degree, 30 * degree}, 1);
  EXPECT_NEAR(AngleAxisd(between).angle(), 2 * std::atan(std::tan(20 * degree) * std::tan(15 * degree)), 1e-15);
}

TEST(Donders, IsContinuousOverheadAndBehind) {
  const auto jump = [](const Vector3d& a, const Vector3d& b) {
    return AngleAxisd(donders(gaze(a), 1).transpose() * donders(gaze(b), 1)).angle();
  };
  const double step = 1e-6;
  for (double way = 0; way < 6; way += 0.7) {
    const Vector3d side(std::sin(way), 0, std::cos(way));
    EXPECT_LT(jump(Vector3d(0, 1, 0) + step * side, Vector3d(0, 1, 0) - step * side), 10 * step);
  }
  EXPECT_LT(jump({step, 0.3, -1}, {-step, 0.3, -1}), 10 * step);
}

TEST(Facing, LooksAgainstTheNormal) {
  const Vector3d normal = Vector3d(0.2, -0.1, -1).normalized();
  EXPECT_LE((facing(normal, 1).col(2) + normal).norm(), 1e-15);
}

// Freedman and Sparks 1997: no head below 20 degrees, eyes 35 degrees in the head when the gaze is at 90
TEST(HeadPart, IsThatOfTheData) {
  const Share share;
  for (double yaw = -20; yaw <= 20; yaw += 5) EXPECT_EQ(head_part({yaw * degree, 0}, share).yaw, 0);
  EXPECT_NEAR(head_part({90 * degree, 0}, share).yaw / degree, 55, 0.5);
  EXPECT_NEAR(head_part({-45 * degree, 0}, share).yaw / degree, -0.79 * 25, 1e-12);
  // never more than the eyes' comfortable reach is left to them, and the head never goes beyond the target
  for (double yaw = 0; yaw <= 180; yaw += 1) {
    const double head = head_part({yaw * degree, 0}, share).yaw / degree;
    EXPECT_LE(head, yaw);
    EXPECT_LE(yaw - head, 35 + 1e-9);
  }
  EXPECT_EQ(head_part({0, 15 * degree}, share).pitch, 0);
  EXPECT_GT(head_part({0, -50 * degree}, share).pitch, -16 * degree);
  EXPECT_NEAR(head_part({0.3, M_PI / 2 - 1e-9}, share).yaw, 0, 1e-9);
}

TEST(HeadLag, IsThatOfTheData) {
  EXPECT_NEAR(head_lag(10 * degree), 0.139, 1e-12);
  EXPECT_NEAR(head_lag(40 * degree), 0.049, 0.0011);
  EXPECT_EQ(head_lag(80 * degree), 0);
}

}  // namespace
}  // namespace head
