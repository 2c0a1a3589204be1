#include "manipulators/eye_control/track.h"

#include <gtest/gtest.h>

#include <cmath>

#include "manipulators/eye_control/vec2.h"

namespace eye::test {
namespace {

using Side = Track::Side;

Track track_of(const std::vector<std::pair<double, double>>& degrees, Track::Jump jump = Track::Jump::on_arrival) {
  Track track(jump, {1, 1, 1});
  for (const auto& [t, x] : degrees) track.add(t, {x * deg, 0, 0});
  return track;
}

double at(const Track& track, double t, Side side) { return track.at(t, side).value.x() / deg; }

TEST(TrackJump, IsToldFromMotionBySampling) {
  // a step of 5 deg at 0.5, sampled at many rates: never a motion
  for (double rate : {1000.0, 500.0, 120.0, 60.0, 30.0}) {
    Track track(Track::Jump::on_arrival, {1, 1, 1});
    for (int k = 0; k <= rate; ++k) track.add(k / rate, {(k / rate >= 0.5 - 1e-9 ? 5 : 0) * deg, 0, 0});
    EXPECT_EQ(at(track, 0.5, Side::left), 0) << rate;
    EXPECT_NEAR(at(track, 0.5, Side::right), 5, 1e-12) << rate;
  }
}

TEST(TrackJump, KeepsTheMotionOfAStepRamp) {
  Track track(Track::Jump::on_arrival, {1, 1, 1});
  for (int k = 0; k <= 1000; ++k) {
    const double t = k / 1000.0;
    track.add(t, {(t < 0.5 ? 10 * t : 10 * t - 3) * deg, 0, 0});
  }
  EXPECT_NEAR(at(track, 0.5, Side::left), 5, 1e-9);
  EXPECT_NEAR(at(track, 0.5, Side::right), 2, 1e-9);
  EXPECT_NEAR(at(track, 0.6, Side::left), 3, 1e-9);
}

TEST(TrackJump, LeavesRampsAndSinesAlone) {
  const Track ramp = track_of({{0, 0}, {0.5, 0}, {1.5, 10}, {3, 10}});
  EXPECT_NEAR(at(ramp, 1.0, Side::left), 5, 1e-12);
  for (double rate : {1000.0, 60.0, 30.0}) {
    Track sine(Track::Jump::on_arrival, {1, 1, 1});
    for (int k = 0; k <= 2 * rate; ++k) sine.add(k / rate, {10 * deg * std::sin(2 * pi * k / rate), 0, 0});
    for (const Track::Knot& knot : sine.knots()) EXPECT_EQ(knot.before, knot.after) << rate;
  }
}

TEST(TrackJump, TwoRowsOfOneTimeAreAJump) {
  const Track track = track_of({{0, 0}, {1, 0}, {1, 7}, {2, 7}});
  EXPECT_EQ(at(track, 1, Side::left), 0);
  EXPECT_NEAR(at(track, 1, Side::right), 7, 1e-12);
  EXPECT_NEAR(at(track, 1.5, Side::left), 7, 1e-12);
}

TEST(TrackJump, OfACommandActsAtTheTickBefore) {
  // ticks of 60 Hz; set between the ticks at 0.5 and 0.51667 s
  Track track(Track::Jump::on_departure, {1, 1, 1});
  for (int k = 0; k <= 60; ++k) track.add(k / 60.0, {(k > 30 ? 5 : 0) * deg, 0, 0});
  EXPECT_EQ(at(track, 0.5, Side::left), 0);
  EXPECT_NEAR(at(track, 0.5, Side::right), 5, 1e-12);
}

TEST(TrackJump, OfTheLastSegmentIsJudgedAgain) {
  Track track(Track::Jump::on_departure, {1, 1, 1});
  for (int k = 0; k <= 30; ++k) track.add(k / 60.0, {0, 0, 0});
  track.add(31 / 60.0, {1 * deg, 0, 0});
  // it may still be the start of a motion
  EXPECT_LT(at(track, 0.501, Side::left), 0.1);
  track.add(32 / 60.0, {1 * deg, 0, 0});
  EXPECT_NEAR(at(track, 0.501, Side::left), 1, 1e-12);
}

TEST(TrackAbsence, BeginsAtOnceWhenSampledFinelyAndHoldsOtherwise) {
  Track fine(Track::Jump::on_arrival, {1, 1, 1});
  for (int k = 0; k <= 100; ++k) fine.add(k / 100.0, {1, 0, 0}, k < 50 || k > 60);
  EXPECT_TRUE(fine.at(0.485, Side::right).present);
  EXPECT_FALSE(fine.at(0.5, Side::right).present);
  EXPECT_FALSE(fine.at(0.605, Side::right).present);
  EXPECT_TRUE(fine.at(0.61, Side::right).present);
  Track coarse(Track::Jump::on_arrival, {1, 1, 1});
  coarse.add(0, {1, 0, 0});
  coarse.add(1, {1, 0, 0}, false);
  coarse.add(2, {1, 0, 0});
  EXPECT_TRUE(coarse.at(0.9, Side::right).present);
  EXPECT_FALSE(coarse.at(1, Side::right).present);
  EXPECT_TRUE(coarse.at(2, Side::right).present);
}

TEST(TrackMemory, ForgetsWhatIsNotNeeded) {
  Track track = track_of({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}});
  track.forget_before(2.5);
  EXPECT_NEAR(at(track, 2.6, Side::left), 2.6, 1e-12);
  EXPECT_LE(track.knots().size(), 4u);
}

}  // namespace
}  // namespace eye::test
