#include "manipulators/head_ik/zyz.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace head {
namespace {

using Exact = Eigen::Matrix<long double, 3, 3>;

// the paper's matrix in extended precision (64-bit mantissa): the witness for rounding errors of doubles
Exact exact_rotation(long double alpha, long double beta, long double gamma) {
  const long double ca = std::cos(alpha), sa = std::sin(alpha), cb = std::cos(beta), sb = std::sin(beta),
                    cg = std::cos(gamma), sg = std::sin(gamma);
  Exact R;
  R << ca * cb * cg - sa * sg, -ca * cb * sg - sa * cg, ca * sb, sa * cb * cg + ca * sg, -sa * cb * sg + ca * cg,
      sa * sb, -sb * cg, sb * sg, cb;
  return R;
}

// angle of the rotation from R to what the angles say
double error(const Exact& R, const Zyz& angles) {
  const Exact D = exact_rotation(angles.alpha, angles.beta, angles.gamma) - R;
  return static_cast<double>(D.norm() / std::sqrt(2.0L));
}

struct Extremes {
  double error = 0;
  bool in_range = true;
};

// `count` orientations with beta = log-uniform distances from a pole, or uniform over all rotations
Extremes extremes(int count, double noise, unsigned seed, bool near_pole) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), exponent(-18, -1), unit(-1, 1);
  Extremes found;
  for (int i = 0; i < count; ++i) {
    const double distance = std::pow(10, exponent(random));
    const double beta = !near_pole ? std::acos(unit(random)) : i % 3 == 0 ? distance : i % 3 == 1 ? M_PI - distance : 0;
    Exact R = exact_rotation(angle(random), beta, angle(random));
    if (noise > 0) R += noise * Exact::NullaryExpr([&] { return static_cast<long double>(unit(random)); });
    const Zyz found_angles = zyz(R.cast<double>());
    found.error = std::max(found.error, error(R, found_angles));
    found.in_range &= std::abs(found_angles.alpha) <= M_PI && std::abs(found_angles.gamma) <= M_PI &&
                      found_angles.beta >= 0 && found_angles.beta <= M_PI;
  }
  return found;
}

// The entries of R and the three angles are doubles: half an ulp of 1 in nine entries (2^-54 rms 3e-17 each) and of pi
// in three angles (2.2e-16 each, two of them about nearly the same axis) bound what any formula can do near 7e-16.
constexpr double rounding = 1e-15;

TEST(Zyz, IsExactForAllOrientations) {
  const Extremes found = extremes(300'000, 0, 1, false);
  EXPECT_LE(found.error, rounding);
  EXPECT_TRUE(found.in_range);
}

TEST(Zyz, IsExactNearAndOnThePoles) {
  const Extremes found = extremes(100'000, 0, 2, true);
  EXPECT_LE(found.error, rounding);
  EXPECT_TRUE(found.in_range);
}

// noise in [-1e-12, 1e-12] on each entry is a matrix of norm up to 3e-12: it must not grow on the way
TEST(Zyz, PassesNoiseOnUnamplified) {
  EXPECT_LE(extremes(100'000, 1e-12, 3, true).error, 4e-12);
  EXPECT_LE(extremes(100'000, 1e-12, 4, false).error, 4e-12);
}

TEST(SlowZyz, IsExactForTenMillionOrientationsAndAMillionNearThePoles) {
  EXPECT_LE(extremes(10'000'000, 0, 5, false).error, rounding);
  EXPECT_LE(extremes(1'000'000, 0, 6, true).error, rounding);
}

TEST(Zyz, HasAlphaZeroOnThePoles) {
  for (const double gamma : {-3.0, -1.0, 0.0, 0.5, 2.0}) {
    const Zyz ahead = zyz(rotation({0, 0, gamma}));
    EXPECT_EQ(ahead.alpha, 0);
    EXPECT_EQ(ahead.beta, 0);
    EXPECT_NEAR(ahead.gamma, gamma, 1e-15);
    Eigen::Matrix3d behind;  // rotation({0, pi, gamma}) without the rounding of pi
    behind << -std::cos(gamma), std::sin(gamma), 0, std::sin(gamma), std::cos(gamma), 0, 0, 0, -1;
    EXPECT_EQ(zyz(behind).alpha, 0);
    EXPECT_EQ(zyz(behind).beta, M_PI);
    EXPECT_NEAR(zyz(behind).gamma, gamma, 1e-15);
  }
}

TEST(Zyz, SurvivesTheSmallestNumbers) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R(0, 2) = 5e-324;
  R(2, 0) = -1e-160;
  const Zyz angles = zyz(R);
  EXPECT_TRUE(std::isfinite(angles.alpha) && std::isfinite(angles.beta) && std::isfinite(angles.gamma));
  EXPECT_LE((rotation(angles) - R).norm(), 1e-15);
}

// The errata. At (0.3, 0.5, 0) the printed rule drops beta and alpha: the two rotations are 0.5 rad apart by beta
// alone, 28.7 degrees, and the rest of alpha goes into gamma.
TEST(PaperRule, FallsIntoTheDegenerateBranchWhereGammaIsZero) {
  const Exact R = exact_rotation(0.3L, 0.5L, 0.0L);
  Eigen::Matrix3d given = R.cast<double>();
  given(2, 1) = 0;
  const auto angle = [&](ZyzRule rule) {
    return std::acos(((rotation(zyz(given, rule)).transpose() * given).trace() - 1) / 2) * 180 / M_PI;
  };
  EXPECT_NEAR(angle(ZyzRule::paper), 28.7, 0.1);
  EXPECT_NEAR(angle(ZyzRule::not_both), 0, 1e-5);
}

TEST(PaperRule, LosesAQuarterTurnAtBetaNinety) {
  Eigen::Matrix3d R;
  R << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  EXPECT_NEAR((rotation(zyz(R, ZyzRule::paper)) - R).norm() / std::sqrt(8.0), std::sin(M_PI / 4), 1e-12);
  EXPECT_LE((rotation(zyz(R)) - R).norm(), 1e-15);
}

TEST(PaperRule, IsHalfATurnOffBehind) {
  const Eigen::Matrix3d R = Eigen::Vector3d(-1, 1, -1).asDiagonal();
  EXPECT_NEAR((rotation(zyz(R, ZyzRule::not_both)) - R).norm() / std::sqrt(8.0), 1, 1e-12);
  EXPECT_EQ(zyz(R).beta, M_PI);
}

// all rules but the paper's agree away from the poles, where the arc cosine has lost nothing yet
TEST(ZyzRules, AgreeInTheOpen) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), middle(0.5, 2.5);
  for (int i = 0; i < 1000; ++i) {
    const Zyz angles{angle(random), middle(random), angle(random)};
    const Eigen::Matrix3d R = rotation(angles);
    for (const ZyzRule rule :
         {ZyzRule::two_step, ZyzRule::half_angle, ZyzRule::arc_cosine, ZyzRule::not_both, ZyzRule::paper}) {
      const Zyz found = zyz(R, rule);
      EXPECT_NEAR(found.alpha, angles.alpha, 3e-15) << name_of(rule);
      EXPECT_NEAR(found.beta, angles.beta, 3e-15) << name_of(rule);
      EXPECT_NEAR(found.gamma, angles.gamma, 3e-15) << name_of(rule);
    }
  }
}

TEST(ZyzRules, HalfAnglesHoldAtThePolesToo) {
  for (const double beta : {0.0, 1e-9, M_PI - 1e-9})
    for (const double alpha : {-2.0, 0.0, 1.0}) {
      const Eigen::Matrix3d R = rotation({alpha, beta, 0.7});
      EXPECT_LE((rotation(zyz(R, ZyzRule::half_angle)) - R).norm(), 2e-15);
    }
}

}  // namespace
}  // namespace head
