#include <gtest/gtest.h>

#include <cmath>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Rows V1, V2, H1 to H3 of the acceptance table. Human values: video head impulse norms 0.97 +- 0.09, Collewijn and
// Smeets 2000 (8.6 ms), Guitton and Volle 1987 (55 deg range), ten people of Jibi to Rinsho 24 (head lag).
namespace eye::test {
namespace {

// the eyes in the dark while the head turns by `head` (deg): only the reflex moves them
struct Shaken {
  Course eyes;
  std::vector<double> head;
};

Shaken shake(const std::function<double(double)>& head, double length, const Parameters& p) {
  FollowingWorld world;
  world.target_track().add(-0.2, {0, 0, 0}, false);
  world.target_track().add(length, {0, 0, 0}, false);
  for (int k = -200; k <= static_cast<int>(1000 * length); ++k) {
    const double t = k / 1000.0;
    world.head_track().add(t, {head(t) * deg, 0, 0});
  }
  Shaken s;
  s.eyes = run(world, p);
  for (double t : s.eyes.t) s.head.push_back(head(t));
  return s;
}

TEST(Vestibular, GainAndLatencyOfAStepInHeadVelocity) {
  // a head that starts to turn at 100 deg/s: the eye follows with the gain, one latency later
  const Shaken s = shake([](double t) { return t < 0 ? 0 : 100 * t; }, 0.3, Parameters{});
  const auto& eye = s.eyes.position;
  const size_t a = s.eyes.index(0.1), b = s.eyes.index(0.2);
  const double speed = -(eye[b] - eye[a]) / 0.1, gain = speed / 100;
  const double latency = 1e3 * (s.eyes.t[a] + eye[a] / speed);
  report("V1", "VOR gain %.3f, latency %.1f ms (people 0.97, 8.6)", gain, latency);
  EXPECT_NEAR(gain, 0.97, 1e-9);
  EXPECT_NEAR(latency, 8.6, 1e-6);
}

TEST(Vestibular, LeavesTheSlipOfItsGainAndLatency) {
  // closed form: |1 - g exp(-i w T)|
  const double frequencies[] = {0.5, 1, 3, 5}, expected[] = {0.040, 0.061, 0.162, 0.267};
  for (int k = 0; k < 4; ++k) {
    const double w = 2 * pi * frequencies[k], speed = 30;
    const Shaken s = shake([&](double t) { return speed / w * std::sin(w * t); }, 4, Parameters{});
    double c = 0, q = 0;
    const size_t from = s.eyes.index(2);
    for (size_t i = from; i + 1 < s.eyes.t.size(); ++i) {
      const double gaze = s.eyes.position[i] + s.head[i];
      c += gaze * std::cos(w * s.eyes.t[i]);
      q += gaze * std::sin(w * s.eyes.t[i]);
    }
    const double n = static_cast<double>(s.eyes.t.size() - 1 - from);
    const double slip = 2 * std::hypot(c, q) / n * w / speed;
    report("V2", "%.1f Hz: gaze slips by %.3f of head velocity (closed form %.3f)", frequencies[k], slip, expected[k]);
    EXPECT_NEAR(slip, expected[k], 0.1 * expected[k]);
  }
}

TEST(Vestibular, HoldsGazeOnATargetWhileTheHeadTurns) {
  // a lit target ahead, the head turning slowly: reflex, optokinetic remainder and corrective saccades together
  FollowingWorld world;
  world.target_track().add(-0.2, {0, 0, 0});
  world.target_track().add(5, {0, 0, 0});
  for (int k = -200; k <= 5000; ++k) {
    const double t = k / 1000.0;
    world.head_track().add(t, {(t < 0 ? 0 : 15 * std::sin(2 * pi * 0.3 * t)) * deg, 0, 0});
  }
  const Course r = run(world, Parameters{});
  for (size_t k = 0; k < r.t.size(); ++k) {
    const double head = r.t[k] < 0 ? 0 : 15 * std::sin(2 * pi * 0.3 * r.t[k]);
    EXPECT_LT(std::abs(r.position[k] + head), 0.8) << r.t[k];
  }
}

TEST(Vestibular, IsOverruledByPursuitOfATargetThatTurnsWithTheHead) {
  // the efference copy of pursuit adds up with the reflex: no cancelling of the one is needed for the other
  FollowingWorld world;
  for (int k = -200; k <= 6000; ++k) {
    const double t = k / 1000.0, angle = t < 0 ? 0 : 10 * std::sin(2 * pi * 0.3 * t);
    world.target_track().add(t, {angle * deg, 0, 0});
    world.head_track().add(t, {angle * deg, 0, 0});
  }
  const Course r = run(world, Parameters{});
  for (size_t k = r.index(3); k < r.t.size(); ++k) EXPECT_LT(std::abs(r.position[k]), 0.8) << r.t[k];
}

TEST(HeadEye, TheHeadsShareStartsAtTwentyDegrees) {
  const Parameters p;
  EXPECT_EQ(head_share(19 * deg, p), 0);
  report("H1", "head share at 15, 30, 60, 90 deg: %.1f %.1f %.1f %.1f deg (monkeys: none below 20, 55 at 90)",
         head_share(15 * deg, p) / deg, head_share(30 * deg, p) / deg, head_share(60 * deg, p) / deg,
         head_share(90 * deg, p) / deg);
  EXPECT_NEAR(head_share(90 * deg, p) / deg, 55.3, 0.1);
}

TEST(HeadEye, TheHeadStartsAfterTheEyes) {
  report("H3", "head lag %.0f ms at 10 deg, %.0f ms at 40 deg (people 139, 50)", 1e3 * head_lag(10 * deg),
         1e3 * head_lag(40 * deg));
  EXPECT_NEAR(head_lag(10 * deg), 0.139, 0.025);
  EXPECT_NEAR(head_lag(40 * deg), 0.050, 0.025);
  EXPECT_GE(head_lag(170 * deg), 0);

  // and in a whole gaze shift: the head's first motion against the eye's
  FollowingWorld world = world_of({{-0.3, 0}, {-0.001, 0}, {0, 40}, {1.5, 40}});
  Parameters p;
  p.head_free = 1;
  const Course r = run(world, p);
  double eye = 0, head = 0;
  for (size_t k = 0; k < r.t.size(); ++k) {
    if (eye == 0 && r.mode[k] == Mode::saccade) eye = r.t[k];
    if (head == 0 && world.turned(r.t[k]).x > 1e-12) head = r.t[k] - 0.001;
  }
  EXPECT_NEAR(head - eye, 0.049, 0.002);
}

TEST(HeadEye, GazeShiftsReachWhereTheEyesAloneCannot) {
  for (double target : {-160.0, -90.0, 15.0, 30.0, 60.0, 90.0, 120.0, 160.0}) {
    FollowingWorld world = world_of({{-0.3, 0}, {-0.001, 0}, {0, target}, {2.5, target}});
    Parameters p;
    p.head_free = 1;
    const Course r = run(world, p);
    double largest = 0;
    for (double eye : r.position) largest = std::max(largest, std::abs(eye));
    const double head = world.turned(2.5).x / deg, error = r.position.back() + head - target;
    const double head_at_peak = world.turned(0.3).x / deg;
    report("H2", "%4.0f deg: eye at most %.1f deg, head %.1f deg (%.0f at 300 ms), gaze error %.3f deg", target,
           largest, head, head_at_peak, error);
    EXPECT_LE(largest, 50 + 1e-9);
    EXPECT_LE(std::abs(error), 0.5);
    if (std::abs(target) < 20) {
      EXPECT_LE(std::abs(head), 0.1 * std::abs(target));
    }
  }
}

TEST(HeadEye, WithTheHeadHeldTheEyesStopAtTheirRange) {
  const Course r = follow({{-0.3, 0}, {-0.001, 0}, {0, 80}, {1.5, 80}}, Parameters{});
  for (double eye : r.position) EXPECT_LE(eye, 50 + 1e-9);
  EXPECT_NEAR(r.position.back(), 50, 1e-6);
}

}  // namespace
}  // namespace eye::test
