#include "manipulators/eye_control/gaze.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

namespace eye::test {
namespace {

// a course with everything in it: steps, ramps, near and far, a hidden stretch, a turning head
void busy(FollowingWorld& world) {
  for (int k = -100; k <= 4000; ++k) {
    const double t = k / 1000.0;
    double azimuth = t < 0.3 ? 0 : t < 1.2 ? 12 : 12 - 18 * (t - 1.2);
    if (t > 2) azimuth = 10 * std::sin(2 * pi * 0.8 * t);
    const bool hidden = t > 3.2 && t < 3.4;
    world.target_track().add(t, {azimuth * deg, 5 * std::sin(3 * t) * deg, t > 0.8 && t < 2.5 ? 2.5 : 0.0}, !hidden);
    world.head_track().add(t, {8 * std::sin(5 * t) * deg, 3 * std::sin(4 * t) * deg, 0});
  }
}

Parameters lively() {
  Parameters p;
  p.later_sigma = 1;
  p.drift_speed = 0.2 * deg;
  p.microsaccade_rate = 1.5;
  p.slip_noise = 0.1 * deg;
  p.blink_rate = 0.5;
  return p;
}

uint64_t bits(const Gaze& gaze) {
  uint64_t hash = 1469598103934665603u;
  for (const auto& [name, row] : gaze.save()) {
    for (double x : row) {
      uint64_t word;
      std::memcpy(&word, &x, sizeof word);
      hash = (hash ^ word) * 1099511628211u;
    }
  }
  return hash;
}

// the eyes as a program sees them that is called at `rate` and makes whole milliseconds
std::vector<uint64_t> called_at(double rate) {
  FollowingWorld world;
  busy(world);
  const auto p = std::make_shared<Parameters>(lively());
  Gaze gaze(p);
  gaze.rest({}, -100);
  std::vector<uint64_t> at_halves;
  for (int64_t tick = 0; tick <= std::llround(4 * rate); ++tick) {
    const double now = static_cast<double>(tick) / rate;
    while (static_cast<double>(gaze.step() + 1) * p->step <= now + 1e-9) gaze.advance(stimulus(world, gaze));
    // rates of 30, 60, 90 and 144 Hz meet at every half second
    if (std::abs(2 * now - std::round(2 * now)) < 1e-9) at_halves.push_back(bits(gaze));
  }
  return at_halves;
}

TEST(Determinism, TheFrameRateChangesNoBit) {
  const auto reference = called_at(1000);
  for (double rate : {30.0, 60.0, 90.0, 144.0}) EXPECT_EQ(called_at(rate), reference) << rate;
  report("N2",
         "internal states at 30, 60, 90, 144 Hz and 1 kHz, head turning, target near and far, all options on: the same "
         "bits");
}

TEST(State, ComesBackFromItsNumbers) {
  FollowingWorld world;
  busy(world);
  const auto p = std::make_shared<Parameters>(lively());
  Gaze whole(p);
  whole.rest({}, -100);
  for (int stop : {150, 620, 900, 1700, 2600, 3300}) {
    while (whole.step() < stop) whole.advance(stimulus(world, whole));
    Gaze again(p);
    ASSERT_TRUE(again.restore(whole.save()));
    EXPECT_EQ(bits(again), bits(whole));
    Gaze reference(p);
    ASSERT_TRUE(reference.restore(whole.save()));
    for (int k = 0; k < 400; ++k) again.advance(stimulus(world, again));
    for (int k = 0; k < 400; ++k) whole.advance(stimulus(world, whole));
    EXPECT_EQ(bits(again), bits(whole)) << stop;
  }
}

TEST(State, ThatDoesNotFitIsRefusedWhole) {
  const auto p = std::make_shared<Parameters>();
  Gaze gaze(p);
  const uint64_t before = bits(gaze);
  auto state = gaze.save();
  state["command"].pop_back();
  EXPECT_FALSE(gaze.restore(state));
  state = gaze.save();
  state.erase("now");
  EXPECT_FALSE(gaze.restore(state));
  EXPECT_FALSE(gaze.restore({}));
  EXPECT_EQ(bits(gaze), before);
}

TEST(Methods, EachAddsToTheOneBefore) {
  const auto lag_of = [](Method method) {
    Parameters p;
    p.method = method;
    const double f = 0.4;
    const Course r = follow(sampled([&](double t) { return t < 0 ? 0 : 8 * std::sin(2 * pi * f * t); }, -0.2, 10), p);
    double sum = 0;
    size_t count = 0;
    for (size_t k = r.index(5); k < r.t.size(); ++k, ++count) {
      sum += std::pow(r.position[k] - 8 * std::sin(2 * pi * f * r.t[k]), 2);
    }
    return std::sqrt(sum / static_cast<double>(count));
  };
  const double snap = lag_of(Method::snap), saccades = lag_of(Method::saccade_only), linear = lag_of(Method::linear),
               full = lag_of(Method::full);
  EXPECT_LT(snap, 1e-9);
  EXPECT_LT(full, linear);
  EXPECT_LT(linear, saccades);
}

TEST(Methods, SnapPointsBothEyesAtANearTargetAtOnce) {
  Parameters p;
  p.method = Method::snap;
  FollowingWorld world;
  world.target_track().add(0, {0, 0, 2});
  world.target_track().add(0.1, {0, 0, 2});
  world.target_track().add(0.1, {20 * deg, 10 * deg, 3});
  world.target_track().add(0.2, {20 * deg, 10 * deg, 3});
  const Course r = run(world, p);
  EXPECT_NEAR(r.vergence[r.index(0.05)], 2 * std::atan(0.063 / 2 * 2) / deg, 1e-9);
  const Eigen::Vector3d point = fick_direction({20 * deg, 10 * deg}) / 3;
  const Aim aim = aim_at(sight_of_point(point, {}), 0.063, 1);
  EXPECT_NEAR(r.position[r.index(0.1)], aim.version.x / deg, 1e-12);
  EXPECT_NEAR(r.vergence.back(), aim.vergence / deg, 1e-12);
}

TEST(Range, IsNeverLeft) {
  FollowingWorld world;
  for (int k = 0; k <= 6000; ++k) {
    const double t = k / 1000.0;
    world.target_track().add(t, {100 * std::sin(2.2 * t) * deg, 70 * std::sin(1.3 * t) * deg, 3});
    world.head_track().add(t, {30 * std::sin(7 * t) * deg, 0, 0});
  }
  const auto p = std::make_shared<Parameters>();
  simulate(world, p, Frame::head, [&](const TraceRow&, const Gaze& gaze) {
    EXPECT_LE(eccentricity(gaze.aim().version), 50 * deg + 1e-9);
    const EyePair eyes = gaze.eyes();
    EXPECT_GE(eyes.left_direction.z(), std::cos(55 * deg) - 1e-9);
    EXPECT_GE(eyes.right_direction.z(), std::cos(55 * deg) - 1e-9);
    EXPECT_NEAR(eyes.left.norm(), 1, 1e-12);
  });
}

TEST(Faults, AreFoundBeforeTheyDoHarm) {
  EXPECT_FALSE(fault(Parameters{}));
  for (const Parameter& row : parameter_table()) {
    Parameters p;
    p.*row.value = row.high * 1.5 + 1;
    ASSERT_TRUE(fault(p)) << row.name;
    EXPECT_NE(fault(p)->find(row.name), std::string::npos);
    p.*row.value = NAN;
    EXPECT_TRUE(fault(p)) << row.name;
  }
}

TEST(Faults, NoParameterWithinItsBoundsMakesNaN) {
  for (const Parameter& row : parameter_table()) {
    for (double value : {row.low, row.high}) {
      Parameters p;
      p.*row.value = value;
      // a step of 20 ms or 10 us makes the run short or long, not different
      if (fault(p) || row.name == "step") continue;
      FollowingWorld world;
      busy(world);
      const Course r = run(world, p);
      EXPECT_TRUE(std::isfinite(r.position.back()) && std::isfinite(r.vergence.back())) << row.name << " " << value;
    }
  }
}

}  // namespace
}  // namespace eye::test
