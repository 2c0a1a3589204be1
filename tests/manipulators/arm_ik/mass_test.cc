#include "manipulators/arm_ik/mass.h"

#include <gtest/gtest.h>

namespace arm_ik {
namespace {

double mass_of(std::initializer_list<Segment> segments, Sex sex) {
  double sum = 0;
  for (const Segment segment : segments) sum += segment_row(segment, sex).mass;
  return sum;
}

// head, trunk and twice the six segments of the limbs are the whole body; the table has four decimals
TEST(Mass, SegmentsAddUpToThePerson) {
  using enum Segment;
  for (const Sex sex : {Sex::male, Sex::female}) {
    const double limbs = 2 * mass_of({upper_arm, forearm, hand, thigh, shank, foot}, sex);
    EXPECT_NEAR(mass_of({head, trunk}, sex) + limbs, 1, 2e-4);
    EXPECT_NEAR(mass_of({upper_trunk, middle_trunk, lower_trunk}, sex), mass_of({trunk}, sex), 1e-12);
  }
}

TEST(Mass, CenterAndInertiaFollowTheTable) {
  const MassProperties arm = mass_properties(Segment::upper_arm, Sex::male, 80, {0.1, 1, 0}, {0.1, 0.7, 0}, {0, 0, 1});
  EXPECT_DOUBLE_EQ(arm.mass, 0.0271 * 80);
  EXPECT_NEAR(arm.center.y(), 1 - 0.5772 * 0.3, 1e-15);
  // sagittal axis z, transverse x, long axis y
  EXPECT_NEAR(arm.inertia(2, 2), arm.mass * 0.285 * 0.285 * 0.09, 1e-15);
  EXPECT_NEAR(arm.inertia(0, 0), arm.mass * 0.269 * 0.269 * 0.09, 1e-15);
  EXPECT_NEAR(arm.inertia(1, 1), arm.mass * 0.158 * 0.158 * 0.09, 1e-15);
  EXPECT_NEAR(arm.inertia(0, 1), 0, 1e-17);
}

// a rigid body's moments obey the triangle inequality, in any direction
TEST(Mass, EveryInertiaIsThatOfARealBody) {
  for (const Sex sex : {Sex::male, Sex::female}) {
    for (std::size_t i = 0; i < segment_words.size(); ++i) {
      const SegmentRow& row = segment_row(static_cast<Segment>(i), sex);
      const double a = row.sagittal * row.sagittal, b = row.transverse * row.transverse,
                   c = row.longitudinal * row.longitudinal;
      EXPECT_LT(a, b + c) << segment_words[i];
      EXPECT_LT(b, a + c) << segment_words[i];
      EXPECT_LT(c, a + b) << segment_words[i];
    }
  }
}

TEST(Mass, EndsThatCoincideGiveAPointMass) {
  const MassProperties point = mass_properties(Segment::hand, Sex::female, 60, {1, 2, 3}, {1, 2, 3}, {0, 0, 1});
  EXPECT_EQ(point.inertia.norm(), 0);
  EXPECT_TRUE(mass_properties(Segment::hand, Sex::female, 60, {0, 0, 0}, {0, 0, 1}, {0, 0, 1}).inertia.allFinite());
}

}  // namespace
}  // namespace arm_ik
