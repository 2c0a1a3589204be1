#include "manipulators/arm_ik/ways.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "manipulators/arm_ik/problems.h"

namespace arm_ik {
namespace {

using kinematics::Pose;

// two turns about one axis: what holds an angle is the line q1 + q2 = angle, as long as both stay within one radian
kinematics::Chain twins() {
  kinematics::ChainBuilder builder("twins");
  for (const char* name : {"a", "b"}) builder.joint(name, kinematics::JointKind::turn, {0, 0, 1}, -1, 1, 0);
  builder.fix({Eigen::Matrix3d::Identity(), {0.3, 0, 0}});
  return builder.finish();
}

Pose turned(double angle) {
  const Eigen::Matrix3d R = kinematics::rotation_z(angle);
  return {R, R * Eigen::Vector3d(0.3, 0, 0)};
}

TEST(Ways, CoverTheWholeConnectedSetUpToItsEnds) {
  const kinematics::Chain chain = twins();
  const Ways ways(chain);
  const auto crowd = ways.connected({Eigen::Vector2d(0.2, 0.1)}, turned(0.3));
  std::vector<double> first;
  for (const auto& q : crowd) {
    EXPECT_NEAR(q.sum(), 0.3, 1e-6);  // Newton stops at 1e-7
    first.push_back(q[0]);
  }
  std::sort(first.begin(), first.end());
  // the line ends where b, then a stands at a limit; the last step is within a fiftieth of the spacing
  EXPECT_NEAR(first.front(), -0.7, 0.002);
  EXPECT_NEAR(first.back(), 1.0, 0.002);
  for (size_t k = 1; k < first.size(); ++k) EXPECT_LT(first[k] - first[k - 1], 0.0501);
}

TEST(Ways, EndWhereTheSetEnds) {
  const kinematics::Chain chain = twins();
  const Ways ways(chain);
  // both joints together reach 2 rad: 40 ticks of 0.0499 rad, not 41
  EXPECT_EQ(ways.goes_on(
                Eigen::Vector2d(-0.9, 0.9), [](double t) { return turned(0.0499 * t); }, 0, 100),
            40);
  EXPECT_EQ(ways.goes_on(
                Eigen::Vector2d(0, 0), [](double) { return turned(0); }, 0, 7),
            7);
}

// a course is its own proof that there is a way
TEST(Ways, GoOnAlongTheCourseThatMadeTheTargets) {
  for (const kinematics::Chain& chain : {iiwa14(), panda()}) {
    const Course fine(chain, 4000, 104);
    const std::vector<double> start = fine.posture(0);
    const auto course = [&](double t) {
      return kinematics::forward(chain, fine.posture(static_cast<int>(std::lround(8 * t))));
    };
    EXPECT_EQ(Ways(chain).goes_on(Eigen::Map<const Eigen::VectorXd>(start.data(), chain.size()), course, 0, 20), 20);
  }
}

}  // namespace
}  // namespace arm_ik
