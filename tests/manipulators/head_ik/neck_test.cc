#include "manipulators/head_ik/neck.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <sstream>

#include "manipulators/head_ik/figure.h"

namespace head {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

Matrix3d random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

// uniform in the box of the totals, then only those of the set
Vector3d random_posture(const Neck& neck, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  for (;;) {
    Vector3d total;
    for (int k = 0; k < 3; ++k) total[k] = neck.lowest()[k] + unit(random) * (neck.highest()[k] - neck.lowest()[k]);
    if (neck.tilt(total) <= 1) return total;
  }
}

double angle_between(const Matrix3d& A, const Matrix3d& B) { return AngleAxisd(A.transpose() * B).angle(); }

bool joints_within_limits(const Neck& neck, const Vector3d& total) {
  std::vector<double> angles(3 * neck.size());
  neck.spread(total, angles.data());
  for (int i = 0; i < neck.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (angles[3 * i + k] < neck.levels()[i].lower[k] || angles[3 * i + k] > neck.levels()[i].upper[k]) return false;
  return true;
}

class Necks : public testing::TestWithParam<bool> {
 protected:
  const Neck neck = GetParam() ? full_neck() : reduced_neck();
};
INSTANTIATE_TEST_SUITE_P(, Necks, testing::Bool(), [](const auto& neck) { return neck.param ? "full" : "reduced"; });

TEST_P(Necks, HaveThePublishedRange) {
  EXPECT_TRUE(neck.highest().isApprox(Vector3d(61, 39, 65) * degree, 1e-12));
  EXPECT_TRUE(neck.lowest().isApprox(Vector3d(-72, -39, -65) * degree, 1e-12));
}

// White and Panjabi's flexion and extension by level, as the design page quotes them from memory: within 1 degree of
// half the published ranges, which shows that shares and ranges belong together.
TEST(FullNeck, HasTheKnownRangeAtEveryLevel) {
  const double flexion_and_extension[] = {9.2, 17.4, 20.5, 20.5, 15.3, 10.2, 18, 22};
  const Neck neck = full_neck();
  ASSERT_EQ(neck.size(), 8);
  for (int i = 0; i < 8; ++i)
    EXPECT_NEAR((neck.levels()[i].upper - neck.levels()[i].lower)[flexion] / degree, flexion_and_extension[i], 0.35);
}

// independent forward kinematics: one AngleAxis after the other through Eigen
TEST_P(Necks, MoveTheHeadAsTheirJointsDo) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 200; ++n) {
    const Vector3d total = random_posture(neck, random);
    std::vector<double> angles(3 * neck.size());
    neck.spread(total, angles.data());
    Isometry3d X = Isometry3d::Identity();
    X.translate(neck.base());
    for (int i = 0; i < neck.size(); ++i) {
      for (int k = 0; k < 3; ++k) X.rotate(AngleAxisd(angles[3 * i + k], Vector3d::Unit(axis_of[k])));
      X.translate(neck.levels()[i].rise);
    }
    EXPECT_LE((X.linear() - neck.rotation(total)).norm(), 1e-14);
    EXPECT_LE((X.translation() - neck.origin_of_head(total)).norm(), 1e-15);
  }
}

TEST_P(Necks, PositiveTotalsAreChinDownRightEarDownFaceLeft) {
  const double small = 0.1;
  EXPECT_LT((neck.rotation({small, 0, 0}) * Vector3d::UnitZ()).y(), -0.05);
  EXPECT_LT((neck.rotation({0, small, 0}) * Vector3d::UnitY()).x(), -0.05);
  EXPECT_GT((neck.rotation({0, 0, small}) * Vector3d::UnitZ()).x(), 0.05);
}

TEST_P(Necks, FindThePostureOfEveryReachableOrientation) {
  std::mt19937_64 random(2);
  for (int n = 0; n < 20'000; ++n) {
    const Vector3d total = random_posture(neck, random);
    const Matrix3d R = neck.rotation(total);
    const Neck::Solution found = neck.solve(R);
    ASSERT_EQ(found.limit, Limit::none) << total.transpose();
    ASSERT_LE(found.iterations, 6);
    // rounding of 24 turns
    ASSERT_LE((neck.rotation(found.total) - R).norm(), 3e-15);
    ASSERT_LE((found.total - total).norm(), 1e-14);
  }
}

TEST_P(Necks, ReachTheEndsOfTheirRange) {
  for (int k = 0; k < 3; ++k)
    for (const double end : {neck.lowest()[k], neck.highest()[k]}) {
      const Vector3d total = end * Vector3d::Unit(k);
      const Neck::Solution inside = neck.solve(neck.rotation(total));
      EXPECT_EQ(inside.limit, Limit::none) << k;
      EXPECT_LE((inside.total - total).norm(), 1e-13);
      const Neck::Solution outside = neck.solve(AngleAxisd(1.1 * end, Vector3d::Unit(axis_of[k])).toRotationMatrix());
      EXPECT_EQ(outside.limit, k == axial ? Limit::axial : Limit::tilt);
      EXPECT_LE((outside.total - total).norm(), 1e-9);
      EXPECT_NEAR(outside.error, 0.1 * std::abs(end), 1e-9);
    }
}

TEST_P(Necks, NeverLeaveTheirLimitsAndAreIdempotent) {
  std::mt19937_64 random(3);
  for (int n = 0; n < 3'000; ++n) {
    const Neck::Solution found = neck.solve(random_rotation(random), n % 2 ? 1 : 0.05);
    ASSERT_LE(neck.tilt(found.total), 1 + 1e-12);
    ASSERT_LE(neck.turn(found.total), 1 + 1e-12);
    ASSERT_TRUE(joints_within_limits(neck, found.total));
    const Neck::Solution again = neck.solve(neck.rotation(found.total));
    ASSERT_EQ(again.limit, Limit::none);
    ASSERT_LE((again.total - found.total).norm(), 1e-10);
  }
}

// The witness is a grid over the whole set: 2176 postures, none of which may be nearer to any of 2000 targets.
TEST(FullNeck, FindsTheNearestPosture) {
  const Neck neck = full_neck();
  std::vector<Matrix3d> grid;
  for (int a = -8; a <= 8; ++a)
    for (int p = 0; p < 32; ++p)
      for (int r = 1; r <= 4; ++r) {
        const double c = std::cos(p * M_PI / 16) * r / 4, s = std::sin(p * M_PI / 16) * r / 4;
        grid.push_back(neck.rotation({c * (c > 0 ? neck.highest() : -neck.lowest())[flexion],
                                      s * neck.highest()[lateral], a / 8.0 * neck.highest()[axial]}));
      }
  std::mt19937_64 random(4);
  for (int n = 0; n < 2000; ++n) {
    const Matrix3d R = random_rotation(random);
    double best = M_PI;
    for (const Matrix3d& posture : grid) best = std::min(best, angle_between(posture, R));
    EXPECT_LE(neck.solve(R).error, best + 1e-9) << n;
  }
}

// A small roll weight keeps the gaze: a head that rolls too far for its neck still looks where it should.
TEST(FullNeck, GivesUpTheRollForTheGaze) {
  const Neck neck = full_neck();
  const Matrix3d R = (AngleAxisd(0.5, Vector3d::UnitY()) * AngleAxisd(1.0, Vector3d::UnitZ())).toRotationMatrix();
  const auto gaze_error = [&](double weight) {
    return std::acos(std::min(1.0, neck.rotation(neck.solve(R, weight).total).col(2).dot(R.col(2))));
  };
  EXPECT_LT(gaze_error(0.01), 0.2 * degree);
  EXPECT_GT(gaze_error(1), 2 * degree);
}

// the reduced neck stands for the full one: same range, and the head moves alike in a small nod and nearly so in a big
// one
TEST(ReducedNeck, CarriesTheHeadAsTheFullOneDoes) {
  const Neck full = full_neck(), reduced = reduced_neck();
  const Vector3d nod(1e-4, 0, 0);
  const Vector3d d_full = full.origin_of_head(nod) - full.origin_of_head({0, 0, 0});
  const Vector3d d_reduced = reduced.origin_of_head(nod) - reduced.origin_of_head({0, 0, 0});
  EXPECT_LE((full.origin_of_head({0, 0, 0}) - reduced.origin_of_head({0, 0, 0})).norm(), 1e-15);
  EXPECT_LE((d_full - d_reduced).norm(), 1e-4 * d_full.norm());
  std::mt19937_64 random(5);
  double worst = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vector3d total = random_posture(full, random);
    worst = std::max(worst, (full.origin_of_head(total) - reduced.origin_of_head(total)).norm());
  }
  RecordProperty("worst_mm", std::to_string(1e3 * worst));
  EXPECT_LT(worst, 0.02);
}

TEST(Neck, WithOneLevelOrWithLockedFreedomsStillAnswers) {
  const Vector3d small(0.3, 0.3, 0.3), none(0, 0, 0);
  const Neck single({{"only", -small, small, none, Vector3d(0, 0.1, 0)}});
  EXPECT_EQ(single.solve(AngleAxisd(0.2, Vector3d::UnitX()).toRotationMatrix()).limit, Limit::none);
  const Vector3d only_axial(0, 0, 0.5);
  const Neck owl({{"only", -only_axial, only_axial, none, Vector3d(0, 0.1, 0)}});
  const Neck::Solution found = owl.solve(AngleAxisd(0.4, Vector3d(0.1, 1, 0).normalized()).toRotationMatrix());
  EXPECT_TRUE(found.total.allFinite());
  EXPECT_EQ(found.total[flexion], 0);
  EXPECT_NEAR(found.total[axial], 0.4, 0.05);
}

TEST(Neck, StartsFromItsRestPosture) {
  const Vector3d range(0.5, 0.5, 0.5), rest(0.2, 0, -0.1);
  const Neck neck({{"a", -range, range, rest, Vector3d(0, 0.1, 0)}, {"b", -range, range, rest, Vector3d(0, 0.1, 0)}});
  double angles[6];
  neck.spread({0, 0, 0}, angles);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(angles[k], rest[k % 3]);
  const Vector3d total(0.3, -0.2, 0.4);
  const Neck::Solution found = neck.solve(neck.rotation(total));
  EXPECT_EQ(found.limit, Limit::none);
  EXPECT_LE((found.total - total).norm(), 1e-13);
}

// the lines of the figure, carried out by the rule of the language: X(position, orientation) Rz(theta0 + angle) Tz(d)
// Tx(a) Rx(alpha)
TEST_P(Necks, AreWhatTheirFigureScriptBuilds) {
  std::mt19937_64 random(6);
  const Vector3d total = random_posture(neck, random), position(0.01, 0.45, -0.02);
  std::vector<double> angles(3 * neck.size());
  neck.spread(total, angles.data());
  std::istringstream script(figure_script(neck, {}, position));
  Isometry3d X = Isometry3d::Identity();
  std::string line, parent = "thorax";
  int joints = 0;
  while (std::getline(script, line)) {
    std::istringstream words(line);
    std::string verb, type, name, word;
    words >> verb >> type >> name >> word;
    ASSERT_EQ(verb, "create");
    words >> word;
    ASSERT_EQ(word, parent);
    parent = name;
    Isometry3d step = Isometry3d::Identity();
    while (words >> word) {
      double a, b, c, d;
      if (word == "position") {
        words >> a >> b >> c;
        step.pretranslate(Vector3d(a, b, c));
      } else if (word == "orientation") {
        words >> a >> b >> c >> d;
        step.rotate(Eigen::Quaterniond(a, b, c, d));
      } else if (word == "dh") {
        words >> a >> b >> c >> d;
        step.rotate(AngleAxisd(a + angles[joints], Vector3d::UnitZ()));
        step.translate(Vector3d(c, 0, b));
        step.rotate(AngleAxisd(d, Vector3d::UnitX()));
      } else {
        words >> a;
        EXPECT_EQ(a, (word == "lower" ? neck.levels()[joints / 3].lower : neck.levels()[joints / 3].upper)[joints % 3]);
      }
    }
    X = X * step;
    if (type == "joint") ++joints;
  }
  EXPECT_EQ(joints, 3 * neck.size());
  EXPECT_EQ(parent, "head");
  EXPECT_LE((X.linear() - neck.rotation(total)).norm(), 1e-14);
  EXPECT_LE((X.translation() - position - neck.origin_of_head(total)).norm(), 1e-15);
}

// one in ten is near a pole of ZYZ, straight ahead or straight behind
TEST(SlowNeck, AnswersTenMillionOrientationsWithinLimits) {
  const Neck neck = full_neck();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  int reached = 0, outside = 0, outside_joints = 0;
  double worst = 0;
  for (int n = 0; n < 10'000'000; ++n) {
    Matrix3d R = random_rotation(random);
    if (n % 10 == 0) {
      const double roll = 0.3 * normal(random);
      R = (AngleAxisd(n % 20 == 0 ? M_PI : 0, Vector3d::UnitY()) * AngleAxisd(roll, Vector3d::UnitZ()) *
           AngleAxisd(1e-9 * normal(random), Vector3d::UnitX()))
              .toRotationMatrix();
    }
    const Neck::Solution found = neck.solve(R, n % 2 ? 1 : 0.3);
    outside += !(found.total.allFinite() && neck.tilt(found.total) <= 1 + 1e-12 && neck.turn(found.total) <= 1 + 1e-12);
    outside_joints += !joints_within_limits(neck, found.total);
    if (found.limit == Limit::none) {
      ++reached;
      worst = std::max(worst, (neck.rotation(found.total) - R).norm());
    }
  }
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(outside_joints, 0);
  EXPECT_GT(reached, 500'000);
  // a posture that is 1e-12 of the range outside is brought to the boundary
  EXPECT_LE(worst, 2e-12);
}

}  // namespace
}  // namespace head
