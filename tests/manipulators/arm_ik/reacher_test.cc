#include "manipulators/arm_ik/reacher.h"

#include <gtest/gtest.h>

#include <cmath>

#include "manipulators/arm_ik/contestants.h"
#include "manipulators/arm_ik/problems.h"

namespace arm_ik {
namespace {

using kinematics::Chain;
using kinematics::Pose;

// the triple that nobody else has: no failed tick, no jump, no drift
TEST(Tracker, FollowsClosedCoursesWithoutFailureJumpOrDrift) {
  const Chain chain = kinematics::arm11();
  const Packed packed(chain);
  const TrackScore score =
      track(chain, 3, 100, [&](double largest) { return follower(chain, packed, 2 * largest / 0.01); });
  EXPECT_EQ(score.ticks, 6000);
  EXPECT_EQ(score.failed, 0);
  EXPECT_EQ(score.jumps, 0);
  EXPECT_LT(score.drift, 1e-9);
}

TEST(Tracker, LeavesReachAndComesBackSmoothly) {
  const Chain chain = kinematics::arm11();
  const Packed packed(chain);
  const TrackScore score = out_and_back(chain, 2, 103, follower(chain, packed, 10));
  EXPECT_EQ(score.failed, 0);
  EXPECT_EQ(score.jumps, 0);
  EXPECT_LE(score.largest_step, 0.1 + 1e-12);
  EXPECT_LT(score.drift, 1e-3);
}

// where the way that was taken ends, another is found and travelled to at the joints' rate
TEST(Tracker, AReacherLeavesADeadEnd) {
  const Chain chain = panda();
  const Packed packed(chain);
  const TrackScore alone =
      track(chain, 5, 100, [&](double largest) { return follower(chain, packed, 2 * largest / 0.01); });
  const TrackScore limb = track(chain, 5, 100, [&](double largest) { return reacher(chain, 2 * largest / 0.01); });
  EXPECT_EQ(limb.jumps, 0);
  EXPECT_LT(limb.failed, alone.failed);
}

Pose in_front(double x, double y, double z) {
  Pose X;
  X.p = {x, y, z};
  return X;
}

std::vector<double> rest_of(const Chain& chain) {
  std::vector<double> q;
  for (const kinematics::Joint& joint : chain.joints) q.push_back(joint.rest);
  return q;
}

class ReacherTest : public ::testing::Test {
 protected:
  static constexpr double dt = 1.0 / 60;

  Solution tick(Reacher& reacher, const Pose& target, std::vector<double>& q, bool fresh = false) {
    Reacher::Order order(Goal(target, false));
    order.rate = rate;
    order.fresh = fresh;
    const std::vector<double> before = q;
    const Solution solution = reacher.tick(order, dt, q);
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_LE(std::abs(q[i] - before[i]), rate * dt * (1 + 1e-12));
      EXPECT_GE(q[i], reacher.chain().joints[i].lower);
      EXPECT_LE(q[i], reacher.chain().joints[i].upper);
    }
    return solution;
  }

  double rate = 5;
};

TEST_F(ReacherTest, TravelsToATargetAndStaysOnIt) {
  for (const kinematics::Side side : {kinematics::Side::right, kinematics::Side::left}) {
    const Chain chain = kinematics::arm11(side);
    const double sign = side == kinematics::Side::right ? 1 : -1;
    Reacher reacher(chain);
    std::vector<double> q = rest_of(chain);
    EXPECT_EQ(tick(reacher, in_front(sign * 0.3, -0.1, -0.4), q).status, Status::moving);
    Solution last;
    for (int t = 0; t < 90; ++t) last = tick(reacher, in_front(sign * 0.3, -0.1, -0.4), q);
    EXPECT_EQ(last.status, Status::reached);
    // carried along slowly it never falls behind
    for (int t = 0; t < 120; ++t) {
      last = tick(reacher, in_front(sign * (0.3 - 0.002 * t), -0.1 + 0.001 * t, -0.4), q);
      EXPECT_EQ(last.status, Status::reached) << t;
    }
  }
}

TEST_F(ReacherTest, SpeedOfAReachIsBellShaped) {
  const Chain chain = kinematics::arm11();
  Reacher reacher(chain);
  std::vector<double> q = rest_of(chain), speeds;
  const Pose target = in_front(0.3, 0.1, -0.4);
  for (int t = 0; t < 90; ++t) {
    const Eigen::Vector3d before = kinematics::forward(chain, q).p;
    (void)tick(reacher, target, q);
    speeds.push_back((kinematics::forward(chain, q).p - before).norm() / dt);
  }
  const auto fastest = std::max_element(speeds.begin(), speeds.end());
  const auto moving = std::find_if(speeds.rbegin(), speeds.rend(), [](double v) { return v > 1e-3; });
  const double end = static_cast<double>(speeds.rend() - moving), peak = static_cast<double>(fastest - speeds.begin());
  EXPECT_LT(speeds.front(), 0.2 * *fastest);
  EXPECT_GT(peak / end, 0.3);
  EXPECT_LT(peak / end, 0.7);
}

TEST_F(ReacherTest, SaysSoWhenTheTargetIsOutOfReachAndComesAlongWhenItReturns) {
  const Chain chain = kinematics::arm11();
  Reacher reacher(chain);
  std::vector<double> q = rest_of(chain);
  Solution last;
  for (int t = 0; t < 120; ++t) last = tick(reacher, in_front(0.5, 0, -2), q);
  EXPECT_EQ(last.status, Status::unreachable);
  EXPECT_NE(reacher.reason(Goal(in_front(0.5, 0, -2), false), last, q).find("reach at most"), std::string::npos);
  for (int t = 0; t < 120; ++t) last = tick(reacher, in_front(0.35, -0.1, -0.35), q);
  EXPECT_EQ(last.status, Status::reached);
}

// what a restarted program needs: the same numbers make the same future, bit for bit
TEST_F(ReacherTest, MemoryCarriesTheWholeState) {
  const Chain chain = kinematics::arm11();
  Reacher one(chain);
  std::vector<double> q = rest_of(chain);
  for (int t = 0; t < 17; ++t) (void)tick(one, in_front(0.3 + 0.001 * t, 0.1, -0.4), q);
  Reacher two(chain);
  ASSERT_TRUE(two.recall(one.memory()));
  std::vector<double> other = q;
  for (int t = 17; t < 150; ++t) {
    const Pose target = in_front(0.3 + 0.001 * t, 0.1, -0.4);
    (void)tick(one, target, q);
    (void)tick(two, target, other);
    ASSERT_EQ(q, other) << t;
  }
  EXPECT_FALSE(two.recall(std::vector<double>{1, 2, 3}));
}

TEST_F(ReacherTest, AnyChainCanReach) {
  const Chain leg = [] {
    kinematics::ChainBuilder builder("leg");
    builder.joint("hip_x", kinematics::JointKind::turn, {1, 0, 0}, -2, 0.3, 0);
    builder.joint("hip_z", kinematics::JointKind::turn, {0, 0, 1}, -0.5, 0.8, 0);
    builder.joint("hip_y", kinematics::JointKind::turn, {0, 1, 0}, -0.8, 0.8, 0)
        .fix({Eigen::Matrix3d::Identity(), {0, -0.42, 0}});
    builder.joint("knee", kinematics::JointKind::turn, {1, 0, 0}, -0.1, 2.3, 0)
        .fix({Eigen::Matrix3d::Identity(), {0, -0.42, 0}});
    return builder.finish();
  }();
  Reacher reacher(leg);
  EXPECT_FALSE(reacher.human().has_value());
  std::vector<double> q = rest_of(leg);
  Solution last;
  for (int t = 0; t < 120; ++t) last = tick(reacher, in_front(0.05, -0.6, 0.3), q);
  EXPECT_EQ(last.status, Status::reached);
}

}  // namespace
}  // namespace arm_ik
