#include "manipulators/arm_ik/descent.h"

#include <gtest/gtest.h>

#include <cstring>

#include "manipulators/arm_ik/problems.h"
#include "manipulators/arm_ik/random.h"
#include "manipulators/arm_ik/tool_pose.h"
#include "manipulators/kinematics/arm11.h"

namespace arm_ik {
namespace {

using kinematics::Chain;
using kinematics::Pose;

std::vector<Chain> chains() {
  return {kinematics::arm11(), kinematics::arm11(kinematics::Side::left), iiwa14(), panda()};
}

// a slide, a skew axis, parallel axes
Chain gantry() {
  kinematics::ChainBuilder builder("gantry");
  builder.joint("x", kinematics::JointKind::slide, {1, 0, 0}, -0.5, 0.5, 0);
  builder.joint("y", kinematics::JointKind::slide, {0, 1, 0}, -0.5, 0.5, 0);
  builder.joint("a", kinematics::JointKind::turn, {0, 0, 1}, -2, 2, 0)
      .fix({Eigen::Matrix3d::Identity(), {0.3, 0, 0.1}});
  builder.joint("b", kinematics::JointKind::turn, {0, 0, 1}, -2, 2, 0).fix({Eigen::Matrix3d::Identity(), {0.2, 0, 0}});
  builder.joint("c", kinematics::JointKind::turn, Eigen::Vector3d(1, 1, 0).normalized(), -2, 2, 0);
  builder.fix({Eigen::Matrix3d::Identity(), {0, 0.1, 0.2}});
  return builder.finish();
}

// the solvers' own forward kinematics against the plain one, which agrees with MuJoCo
TEST(ToolPose, AgreesWithPlainForwardKinematics) {
  Random random(1);
  std::vector<Chain> all = chains();
  all.push_back(gantry());
  for (const Chain& chain : all) {
    const Packed packed(chain);
    for (int sample = 0; sample < 200; ++sample) {
      std::vector<double> q;
      for (const kinematics::Joint& joint : chain.joints) q.push_back(random.between(joint.lower, joint.upper));
      double frame[16];
      tool_pose(packed, q.data(), frame);
      const Pose X = kinematics::forward(chain, q);
      for (int row = 0; row < 3; ++row) {
        // a few roundings a joint, lengths below a metre
        for (int column = 0; column < 3; ++column) EXPECT_NEAR(frame[4 * column + row], X.R(row, column), 4e-15);
        EXPECT_NEAR(frame[12 + row], X.p[row], 4e-15);
      }
    }
  }
}

TEST(Descent, ArrivesFromNearbyWithinLimitsAndTellsTheTruth) {
  for (const Chain& chain : chains()) {
    const Packed packed(chain);
    int reached = 0;
    for (const Problem& problem : problems(chain, ProblemSet::warm, 300, 5)) {
      std::vector<double> q = problem.start;
      const DescentResult result = descend(packed, Goal(problem.target, true), {}, q.data(), best_isa());
      reached += result.reached;
      const Pose at = kinematics::forward(chain, q);
      EXPECT_NEAR(result.position_error, (at.p - problem.target.p).norm(), 1e-14);
      EXPECT_NEAR(result.rotation_error, kinematics::rotation_distance(at.R, problem.target.R), 1e-14);
      for (int i = 0; i < chain.size(); ++i) {
        EXPECT_GE(q[i], chain.joints[i].lower);
        EXPECT_LE(q[i], chain.joints[i].upper);
      }
    }
    // seven freedoms leave a few targets at limits to other starts
    EXPECT_GE(reached, 298) << chain.name;
  }
}

TEST(Descent, SameBitsOnEveryProcessor) {
  for (const Chain& chain : chains()) {
    const Packed packed(chain);
    for (const ProblemSet set : {ProblemSet::random, ProblemSet::near_limit}) {
      for (const Problem& problem : problems(chain, set, 100, 6)) {
        std::vector<double> wide = problem.start, narrow = problem.start;
        const DescentResult a = descend(packed, Goal(problem.target, true), {}, wide.data(), best_isa());
        const DescentResult b = descend(packed, Goal(problem.target, true), {}, narrow.data(), Isa::portable);
        EXPECT_EQ(std::memcmp(wide.data(), narrow.data(), wide.size() * sizeof(double)), 0);
        EXPECT_EQ(a.iterations, b.iterations);
      }
    }
  }
}

// quadratic convergence: from 1e-3 to 1e-12 takes two more steps
TEST(Descent, AccuracyCostsLittle) {
  const Chain chain = kinematics::arm11();
  const Packed packed(chain);
  double loose = 0, tight = 0;
  for (const Problem& problem : problems(chain, ProblemSet::warm, 300, 7)) {
    DescentOptions options;
    options.position_tolerance = 1e-3;
    options.rotation_tolerance = 1e-2;
    std::vector<double> q = problem.start;
    loose += descend(packed, Goal(problem.target, true), options, q.data(), best_isa()).iterations;
    options.position_tolerance = 1e-12;
    options.rotation_tolerance = 1e-11;
    q = problem.start;
    const DescentResult result = descend(packed, Goal(problem.target, true), options, q.data(), best_isa());
    EXPECT_TRUE(result.reached);
    tight += result.iterations;
  }
  EXPECT_LT(tight - loose, 2.5 * 300);
}

// where it stops short of a target, no small step inside the limits lowers the error: central differences
TEST(Descent, StopsAtANearestPosture) {
  const Chain chain = kinematics::arm11();
  const Packed packed(chain);
  int stationary = 0;
  for (const Problem& problem : problems(chain, ProblemSet::unreachable, 40, 8)) {
    const Goal goal(problem.target, false);
    DescentOptions options;
    options.iterations = 3000;
    std::vector<double> q = problem.start;
    const DescentResult result = descend(packed, goal, options, q.data(), best_isa());
    ASSERT_FALSE(result.reached);
    if (!result.stationary) continue;
    ++stationary;
    const auto distance = [&] { return (kinematics::forward(chain, q).p - problem.target.p).norm(); };
    for (int i = 0; i < chain.size(); ++i) {
      const double at = q[i], h = 1e-6;
      q[i] = at + h;
      const double after = distance();
      q[i] = at - h;
      const double before = distance();
      q[i] = at;
      double slope = (after - before) / (2 * h);
      // at a limit only the way back counts
      if (at >= chain.joints[i].upper) slope = std::max(slope, 0.0);
      if (at <= chain.joints[i].lower) slope = std::min(slope, 0.0);
      // it stops when a step gains less than 1e-9 of the squared error: slopes of a millimetre a radian are left
      EXPECT_NEAR(slope, 0, 2e-3) << chain.joints[i].name;
    }
  }
  EXPECT_GT(stationary, 35);
}

TEST(Descent, SlidesAndSkewAxesAreFreedomsLikeOthers) {
  const Chain chain = gantry();
  const Packed packed(chain);
  int reached = 0;
  for (const Problem& problem : problems(chain, ProblemSet::warm, 200, 9)) {
    std::vector<double> q = problem.start;
    reached += descend(packed, Goal(problem.target, true), {}, q.data(), best_isa()).reached;
  }
  EXPECT_GE(reached, 196);
}

}  // namespace
}  // namespace arm_ik
