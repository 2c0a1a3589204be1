#include "manipulators/flight/course.h"

#include <gtest/gtest.h>

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using flight::Course;

TEST(Course, GoesThroughItsPointsAndStandsStillOutside) {
  const std::vector<Vector3d> points = {{0, 1, 2}, {1, 1, 0}, {4, -2, 1}, {4, 0, 0}};
  const Course course(points, {1, 2, 2.5, 4});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((course.at(std::vector<double>{1, 2, 2.5, 4}[i]).p - points[i]).norm(), 1e-12);
  }
  EXPECT_EQ(course.at(0).p, points[0]);
  EXPECT_EQ(course.at(9).p, points[3]);
  EXPECT_EQ(course.at(9).v, Vector3d::Zero());
}

TEST(Course, ALineIsFlownAtEvenSpeed) {
  const Course course({{0, 0, 0}, {1, 2, 3}, {3, 6, 9}}, {0, 1, 3});
  for (double t = 0.05; t < 3; t += 0.1) {
    EXPECT_LT((course.at(t).p - t * Vector3d(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((course.at(t).v - Vector3d(1, 2, 3)).norm(), 1e-12);
  }
}

TEST(Course, VelocityAndAccelerationAreTheDerivativesAndDoNotJump) {
  const Course course({{0, 0, 0}, {1, 2, -1}, {3, 1, 0}, {2, -1, 2}, {0, 0, 3}}, {0, 0.7, 2, 2.4, 4});
  const double h = 1e-5;
  for (double t = 0.03; t < 3.97; t += 0.07) {
    const Vector3d slope = (course.at(t + h).p - course.at(t - h).p) / (2 * h);
    EXPECT_LT((course.at(t).v - slope).norm(), 1e-7);
    const Vector3d bend = (course.at(t + h).v - course.at(t - h).v) / (2 * h);
    // central differences across a knot, where the third derivative jumps, are off by its jump times h
    EXPECT_LT((course.at(t).a - bend).norm(), 1e-3);
  }
  for (double knot : {0.7, 2.0, 2.4}) {
    EXPECT_LT((course.at(knot - 1e-9).v - course.at(knot + 1e-9).v).norm(), 1e-6);
    EXPECT_LT((course.at(knot - 1e-9).a - course.at(knot + 1e-9).a).norm(), 1e-6);
  }
  // natural ends
  EXPECT_LT(course.at(1e-9).a.norm(), 1e-6);
}

TEST(Course, WhatIsNoWayIsTold) {
  EXPECT_EQ(Course({}, {}).problem(), "way has no points");
  EXPECT_EQ(Course({{0, 0, 0}}, {}).problem(), "way has 1 points, times has 0");
  EXPECT_EQ(Course({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {0, 2, 2}).problem(), "times do not rise at number 2");
  EXPECT_TRUE(Course({{0, 0, 0}, {1, 0, 0}}, {1, 0}).empty());
  const Course place({{1, 2, 3}}, {5});
  EXPECT_EQ(place.problem(), "");
  EXPECT_EQ(place.at(0).p, Vector3d(1, 2, 3));
}

TEST(Attitude, InATurnThePullIsStraightDownThroughTheBody) {
  Course::State turn;
  turn.v = {0, 0, 8};
  turn.a = {9.81, 0, 0};  // to its left: it leans left by 45 degrees
  const Quaterniond q = flight::attitude(turn, 1, Quaterniond::Identity());
  EXPECT_LT((q * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((q * Vector3d::UnitY() - Vector3d(1, 1, 0).normalized()).norm(), 1e-12);
  EXPECT_LT((flight::attitude(turn, 0, q) * Vector3d::UnitY() - Vector3d::UnitY()).norm(), 1e-12);
}

TEST(Attitude, StandingStillKeepsTheHeadingAndIsLevel) {
  const Quaterniond before(Eigen::AngleAxisd(0.7, Vector3d::UnitY()) * Eigen::AngleAxisd(0.4, Vector3d::UnitZ()));
  const Quaterniond q = flight::attitude({}, 1, before);
  EXPECT_LT((q * Vector3d::UnitY() - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_NEAR((q * Vector3d::UnitZ()).dot(Vector3d(std::sin(0.7), 0, std::cos(0.7))), 1, 1e-12);
  Course::State up;
  up.v = {0, 3, 0};
  EXPECT_TRUE(flight::attitude(up, 1, before).isApprox(before));
}

TEST(Wings, BeatWhenItClimbsAndGlideWhenItSinks) {
  EXPECT_NEAR(flight::wing_angle(1.57, 0.6, 2), 0.72, 1e-3);
  EXPECT_NEAR(flight::wing_angle(1.57, 0.6, -2), 0.12, 1e-12);
  EXPECT_GT(flight::wing_angle(1.57, 0.6, 0.5), flight::wing_angle(1.57, 0.6, 0));
}

}  // namespace
