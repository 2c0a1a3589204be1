#include "manipulators/arm_ik/workspace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "manipulators/arm_ik/problems.h"
#include "manipulators/arm_ik/random.h"
#include "manipulators/arm_ik/solver.h"
#include "manipulators/kinematics/arm11.h"

namespace arm_ik {
namespace {

using kinematics::Chain;
using kinematics::ChainBuilder;
using kinematics::JointKind;
using kinematics::Pose;

Chain crane() {
  ChainBuilder builder("crane");
  builder.fix({kinematics::rotation_x(0.3), {0.1, 0.2, -0.3}});
  builder.joint("mast", JointKind::turn, {0, 1, 0}, -4, 4, 0).fix({Eigen::Matrix3d::Identity(), {0, 0.5, 0}});
  builder.joint("boom", JointKind::turn, {0, 0, 1}, -0.2, 1.2, 0);
  builder.joint("slide", JointKind::slide, {1, 0, 0}, 0.3, 1.1, 0.3);
  builder.joint("hook", JointKind::slide, {0, 1, 0}, -0.6, -0.1, -0.1);
  builder.fix({kinematics::rotation_z(0.7), {0.05, 0, 0.02}});
  return builder.finish();
}

// the proof must never be wrong: what a posture reaches, corners of the limits included, is not excluded
TEST(Workspace, ExcludesNothingThatAPostureReaches) {
  for (const Chain& chain :
       {kinematics::arm11(), kinematics::arm11(kinematics::Side::left), panda(), iiwa14(), crane()}) {
    const Workspace workspace{Packed(chain)};
    Random random(31);
    for (int sample = 0; sample < 4000; ++sample) {
      std::vector<double> q;
      for (const kinematics::Joint& joint : chain.joints) {
        const double share = random.between(-0.5, 1.5);
        q.push_back(joint.lower + std::clamp(share, 0.0, 1.0) * (joint.upper - joint.lower));
      }
      const Goal goal(kinematics::forward(chain, q), true);
      ASSERT_FALSE(workspace.excludes_at_once(goal)) << chain.name << " " << sample;
      ASSERT_FALSE(workspace.excludes(goal)) << chain.name << " " << sample;
      ASSERT_EQ(workspace.distance_bound(goal), 0) << chain.name << " " << sample;
    }
  }
}

// one link of a metre that turns all the way round: the hull is a disc
TEST(Workspace, DistanceBoundOfADiscIsItsDistance) {
  ChainBuilder builder("link");
  builder.joint("turn", JointKind::turn, {0, 0, 1}, -M_PI, M_PI, 0).fix({Eigen::Matrix3d::Identity(), {1, 0, 0}});
  const Workspace workspace{Packed(builder.finish())};
  const auto bound = [&](double x, double y, double z) {
    Pose X;
    X.p = {x, y, z};
    return workspace.distance_bound(Goal(X, false));
  };
  // the slack: height of the arc of 6 degrees and of the octahedron's faces, 0.3 %
  EXPECT_NEAR(bound(3, 0, 0), 2, 0.01);
  EXPECT_NEAR(bound(-2, 2, 0), std::sqrt(8) - 1, 0.01);
  EXPECT_NEAR(bound(0, 0, 1), 1, 0.01);
  EXPECT_NEAR(bound(2, 0, 1), std::sqrt(2), 0.01);
  EXPECT_LE(bound(3, 0, 0), 2);
  EXPECT_EQ(bound(0.5, 0.5, 0), 0);
}

TEST(Workspace, AnswersOutOfReachMissByLittleMoreThanTheBound) {
  const Chain chain = kinematics::arm11();
  Solver solver(chain);
  const Workspace workspace(solver.packed());
  double bounds = 0, misses = 0;
  for (const Problem& problem : problems(chain, ProblemSet::unreachable, 200, 32)) {
    const Goal goal(problem.target, false);
    double q[11];
    const Solution solution = solver.reach(goal, {}, q);
    const double bound = workspace.distance_bound(goal);
    EXPECT_LE(bound, solution.position_error + 1e-9);
    bounds += bound;
    misses += solution.position_error;
  }
  // the hull is larger than the workspace where that is hollow, and by the tables' slack
  EXPECT_GT(bounds, 0.97 * misses);
}

// the other proof: the base cannot stand where the target's orientation would put it
TEST(Workspace, ExcludesPlacesInReachThatAnOrientationForbids) {
  ChainBuilder builder("finger");
  builder.joint("one", JointKind::turn, {0, 0, 1}, -0.5, 0.5, 0).fix({Eigen::Matrix3d::Identity(), {1, 0, 0}});
  builder.joint("two", JointKind::turn, {0, 0, 1}, -0.5, 0.5, 0).fix({Eigen::Matrix3d::Identity(), {1, 0, 0}});
  const Workspace workspace{Packed(builder.finish())};
  Pose X;
  X.p = {1.95, 0, 0};
  EXPECT_FALSE(workspace.excludes(Goal(X, true)));
  X.R = kinematics::rotation_z(M_PI);
  EXPECT_FALSE(workspace.excludes(Goal(X, false)));
  EXPECT_TRUE(workspace.excludes(Goal(X, true)));
}

}  // namespace
}  // namespace arm_ik
