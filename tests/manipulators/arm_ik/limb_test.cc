#include "manipulators/arm_ik/limb.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

#include "manipulators/arm_ik/random.h"

namespace arm_ik {
namespace {

std::vector<double> random_posture(const kinematics::Chain& chain, Random& random) {
  std::vector<double> q;
  for (const kinematics::Joint& joint : chain.joints) q.push_back(random.between(joint.lower, joint.upper));
  return q;
}

TEST(Lanes, AngleOfIsTheArcTangent) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double angle = random.between(-M_PI, M_PI), r = std::exp(random.between(-5, 5));
    const double y = r * std::sin(angle), x = r * std::cos(angle);
    const double got = angle_of<1>(Lanes<1>::Real{y}, Lanes<1>::Real{x})[0];
    // two units in the last place of an angle up to pi
    EXPECT_NEAR(got, std::atan2(y, x), 9e-16);
  }
  const double corners[8][2] = {{0, 0}, {0, 1}, {1, 0}, {-1, 0}, {0, -1}, {1, 1}, {-1, -1}, {1e-300, 1e300}};
  for (const auto& c : corners)
    EXPECT_NEAR(angle_of<1>(Lanes<1>::Real{c[0]}, Lanes<1>::Real{c[1]})[0], std::atan2(c[0], c[1]), 9e-16);
}

TEST(Lanes, SineAndCosineAreTheLibrarys) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.between(-50, 50);
    Lanes<1>::Real s, c;
    sine_cosine<1>(Lanes<1>::Real{x}, s, c);
    // one unit in the last place of 1
    EXPECT_NEAR(s[0], std::sin(x), 2.3e-16);
    EXPECT_NEAR(c[0], std::cos(x), 2.3e-16);
  }
}

class LimbOfArm : public ::testing::TestWithParam<kinematics::Side> {};

// position by construction: forward kinematics brings every target back, whatever the girdle and the swivel
TEST_P(LimbOfArm, PutsTheWristOnTheTargetExactly) {
  const HumanArm arm = *HumanArm::recognize(kinematics::arm11(GetParam()));
  Random random(3);
  double worst = 0;
  int within = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> q = random_posture(arm.chain(), random);
    const Eigen::Vector3d target = kinematics::forward(arm.chain(), q).p;
    const Limb limb(arm, q);
    const Limb::Answer answer = limb.solve(target, random.between(-3, 3));
    ASSERT_TRUE(answer.reachable);
    std::copy_n(answer.q, 4, q.begin() + 6);
    worst = std::max(worst, (kinematics::forward(arm.chain(), q).p - target).norm());
    const Limb::Answer inside = limb.solve_within_limits(target);
    within += inside.excess <= 0;
    std::copy_n(inside.q, 4, q.begin() + 6);
    worst = std::max(worst, (kinematics::forward(arm.chain(), q).p - target).norm());
  }
  EXPECT_LT(worst, 1e-13);
  // the posture the target came from is within the limits, so some swivel is; 32 samples find nine in ten
  EXPECT_GT(within, 1800);
}

TEST_P(LimbOfArm, EightAtOnceGiveTheSameBitsOnEveryProcessor) {
  const HumanArm arm = *HumanArm::recognize(kinematics::arm11(GetParam()));
  Random random(4);
  const std::vector<double> girdle = random_posture(arm.chain(), random);
  const Limb limb(arm, girdle);
  for (int batch = 0; batch < 50; ++batch) {
    double targets[24];
    for (double& t : targets) t = random.between(-0.4, 0.4);
    Limb::Answer all[8], portable[8];
    limb.solve_eight(targets, all);
    limb.solve_eight(targets, portable, Isa::portable);
    for (int lane = 0; lane < 8; ++lane) {
      const Limb::Answer one = limb.solve({targets[lane], targets[8 + lane], targets[16 + lane]});
      EXPECT_EQ(std::memcmp(one.q, all[lane].q, sizeof one.q), 0);
      EXPECT_EQ(std::memcmp(one.q, portable[lane].q, sizeof one.q), 0);
    }
  }
}

TEST_P(LimbOfArm, PointsAtATargetOutOfReach) {
  const HumanArm arm = *HumanArm::recognize(kinematics::arm11(GetParam()));
  std::vector<double> q;
  for (const kinematics::Joint& joint : arm.chain().joints) q.push_back(joint.rest);
  const Limb limb(arm, q);
  const Eigen::Vector3d shoulder = kinematics::frames(arm.chain(), q)[7].p;
  const Eigen::Vector3d target = shoulder + Eigen::Vector3d(2, -1, -1);
  const Limb::Answer answer = limb.solve(target);
  EXPECT_FALSE(answer.reachable);
  std::copy_n(answer.q, 4, q.begin() + 6);
  const Eigen::Vector3d wrist = kinematics::forward(arm.chain(), q).p - shoulder;
  EXPECT_LT(wrist.normalized().cross((target - shoulder).normalized()).norm(), 1e-13);
}

TEST_P(LimbOfArm, MethodReachesWithAGirdleInRhythm) {
  const HumanArm arm = *HumanArm::recognize(kinematics::arm11(GetParam()));
  const double side = GetParam() == kinematics::Side::right ? 1 : -1;
  Random random(5);
  int reached = 0;
  for (int i = 0; i < 300; ++i) {
    // a posture in rhythm, so that the target can be reached in rhythm
    std::vector<double> q = random_posture(arm.chain(), random);
    q[10] = arm.chain().joints[10].rest;
    for (int pass = 0; pass < 60; ++pass) {
      const auto direction = HumanArm::direction(arm.humerus(q), 0);
      const GirdleAngles girdle = arm.girdle_of(direction[0], direction[1]);
      std::copy(girdle.begin(), girdle.end(), q.begin());
    }
    const Eigen::Vector3d there = kinematics::forward(arm.chain(), q).p;
    const Goal goal({Eigen::Matrix3d::Identity(), {side * there.x(), there.y(), there.z()}}, false);
    const Solution solution = solve_limb(arm, goal, {}, true, q);
    if (solution.status != Status::reached) continue;
    ++reached;
    EXPECT_LT(solution.position_error, 1e-13);
    // the mirror image of the arm is solved, the joint values are the arm's own
    EXPECT_LT((kinematics::forward(kinematics::arm11(GetParam()), q).p - goal.target().p).norm(), 2e-13);
  }
  // the least turn and 32 samples of the swivel find most of what limits and rhythm allow
  EXPECT_GT(reached, 240);
}

INSTANTIATE_TEST_SUITE_P(Sides, LimbOfArm, ::testing::Values(kinematics::Side::right, kinematics::Side::left));

}  // namespace
}  // namespace arm_ik
