#include "manipulators/eye_control/restless.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Row F1 of the acceptance table.
namespace eye::test {
namespace {

TEST(Restlessness, IsOffByDefault) {
  const Course r = follow({{0, 0}, {5, 0}}, Parameters{});
  for (double x : r.position) EXPECT_EQ(x, 0);
  for (Mode mode : r.mode) EXPECT_EQ(mode, Mode::fixation);
}

TEST(Restlessness, MicrosaccadesAreSmallAndLieOnTheMainSequence) {
  Parameters p;
  p.microsaccade_rate = 1.5;
  p.seed = 3;
  const double length = 200;
  const Course r = follow({{0, 0}, {length, 0}}, p);
  const double rate = static_cast<double>(r.saccades.back()) / length;
  int count = 0;
  double largest = 0, worst = 0, farthest = 0;
  for (size_t k = 1; k < r.t.size(); ++k) {
    farthest = std::max(farthest, std::hypot(r.position[k], r.elevation[k]));
    if (r.saccades[k] == r.saccades[k - 1]) continue;
    // amplitude and peak speed over the 40 ms after its start
    double peak = 0;
    const size_t end = std::min(k + 40, r.t.size() - 1);
    for (size_t i = k; i < end; ++i) peak = std::max(peak, r.speed[i]);
    const double amplitude = std::hypot(r.position[end] - r.position[k - 1], r.elevation[end] - r.elevation[k - 1]);
    largest = std::max(largest, amplitude);
    // the line of the burst generator for small saccades, 58 deg/s at 1 deg
    if (amplitude > 0.1) worst = std::max(worst, std::abs(peak / (58 * amplitude) - 1));
    ++count;
  }
  report("F1", "microsaccades %.2f a second (people 1-2), largest %.2f deg, gaze within %.2f deg", rate, largest,
         farthest);
  EXPECT_GE(rate, 1);
  EXPECT_LE(rate, 2);
  EXPECT_LT(largest, 1);
  EXPECT_LT(worst, 0.35);
  EXPECT_LT(farthest, 1.5);
}

TEST(Restlessness, BlinksCloseFasterThanTheyOpen) {
  Parameters p;
  p.blink_rate = 0.25;
  FollowingWorld world = world_of({{0, 0}, {600, 0}});
  int blinks = 0;
  double deepest = 0, closing = 0, opening = 0, before = 0;
  simulate(world, std::make_shared<Parameters>(p), Frame::head, [&](const TraceRow& row, const Gaze& gaze) {
    const double lid = gaze.lid();
    if (lid > 0) {
      EXPECT_EQ(row.mode, Mode::blink);
    }
    blinks += before == 0 && lid > 0;
    deepest = std::max(deepest, lid);
    closing = std::max(closing, lid - before);
    opening = std::max(opening, before - lid);
    before = lid;
  });
  report("F1", "%.1f blinks a minute (people 11-19), closing %.0f %% faster than opening (people 40-47)", blinks / 10.0,
         100 * (closing / opening - 1));
  EXPECT_NEAR(blinks / 10.0, 15, 4);
  EXPECT_NEAR(closing / opening, 1.435, 0.035);
  EXPECT_NEAR(deepest, 0.9, 1e-3);
}

TEST(Restlessness, DriftHasItsSpeedAndStaysNearTheTarget) {
  Parameters p;
  p.drift_speed = 0.3 * deg;
  const Course r = follow({{0, 0}, {100, 0}}, p);
  double sum = 0, farthest = 0;
  for (size_t k = 1; k < r.t.size(); ++k) {
    if (r.mode[k] == Mode::saccade) continue;
    sum += std::pow((r.position[k] - r.position[k - 1]) * 1000, 2);
    farthest = std::max(farthest, std::hypot(r.position[k], r.elevation[k]));
  }
  // 100 s hold 1000 correlation times of 0.1 s: the root mean square is known to about 3 %
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(r.t.size())), 0.3, 0.04);
  EXPECT_LT(farthest, 1.0);
}

TEST(Restlessness, TheSameSeedGivesTheSameMotion) {
  Parameters p;
  p.drift_speed = 0.3 * deg;
  p.microsaccade_rate = 1.5;
  p.blink_rate = 0.3;
  p.later_sigma = 1;
  const std::vector<At> course{{0, 0}, {1, 0}, {1.001, 5}, {6, 5}};
  const Course a = follow(course, p), b = follow(course, p);
  EXPECT_EQ(a.position, b.position);
  p.seed = 2;
  EXPECT_NE(follow(course, p).position, a.position);
}

}  // namespace
}  // namespace eye::test
