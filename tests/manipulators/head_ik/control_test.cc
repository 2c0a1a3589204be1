#include "manipulators/head_ik/control.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

namespace head {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

Sight at(const Vector3d& place) { return {Sight::point, place, Vector3d::UnitZ()}; }
Sight toward(double yaw, double pitch, double distance = 10) {
  return at(Vector3d(0, 0.17, 0.1) + distance * direction({yaw * degree, pitch * degree}));
}

struct Course {
  Control control;
  Control::Report last;
  double largest_step = 0, peak_speed = 0, first_motion = -1;
};

// `seen` as a function of time, at `rate` ticks a second; a shorter last tick would end it
Course course(const Neck& neck, const Settings& settings, double rate, double duration,
              const std::function<Sight(double)>& seen) {
  Course run;
  Vector3d before(0, 0, 0);
  const int ticks = static_cast<int>(std::lround(duration * rate));
  for (int n = 1; n <= ticks; ++n) {
    const double time = n / rate;
    run.last = run.control.tick(neck, settings, time, 1 / rate, seen(time), false);
    const double moved = (run.last.posture - before).norm();
    run.largest_step = std::max(run.largest_step, moved);
    run.peak_speed = std::max(run.peak_speed, moved * rate);
    if (run.first_motion < 0 && moved > 1e-6) run.first_motion = time;
    before = run.last.posture;
  }
  return run;
}

class Heads : public testing::Test {
 protected:
  const Neck neck = full_neck();
  Settings settings;
};

TEST_F(Heads, LookAtATargetWhenTheyDoItAlone) {
  settings.part = Part::full;
  for (const auto& [yaw, pitch] : {std::pair(30, 20), std::pair(-50, -10), std::pair(0, 40), std::pair(5, -30)}) {
    const Course done = course(neck, settings, 60, 4, [&](double) { return toward(yaw, pitch, 0.8); });
    EXPECT_EQ(done.last.status, Status::reached) << yaw << " " << pitch;
    // arrival: three lags of 68 ms in 3.6 s leave exp(-50) of the way; the fixed point is left at 1e-7 m
    EXPECT_LT(done.last.gaze_error, 2e-7);
  }
}

TEST_F(Heads, LeaveSmallShiftsToTheEyes) {
  const Course done = course(neck, settings, 60, 2, [](double) { return toward(19, 10); });
  EXPECT_EQ(done.last.posture.norm(), 0);
  EXPECT_EQ(done.last.status, Status::reached);
  EXPECT_NEAR(done.last.gaze_error, std::acos(std::cos(19 * degree) * std::cos(10 * degree)), 0.01);
}

TEST_F(Heads, TakeTheirShareOfBigShifts) {
  const Course done = course(neck, settings, 60, 3, [](double) { return toward(60, 0, 100); });
  EXPECT_NEAR(done.last.posture[axial] / degree, 0.79 * 40, 0.5);
  EXPECT_NEAR(done.last.gaze_error / degree, 60 - 0.79 * 40, 0.5);
}

// 200 ms of the eyes and 49 ms of the head at 40 degrees; the third lag shows 1e-6 rad some milliseconds later
TEST_F(Heads, StartAfterTheEyes) {
  const Course done = course(neck, settings, 1000, 1, [](double) { return toward(40, 0); });
  EXPECT_NEAR(done.first_motion, 0.249, 0.010);
  const Course slower = course(neck, settings, 1000, 1, [](double) { return toward(25, 0); });
  EXPECT_NEAR(slower.first_motion, 0.2 + 0.094, 0.012);
}

TEST_F(Heads, AreFasterInBiggerShifts) {
  double before = 0;
  for (const double yaw : {30.0, 45.0, 60.0, 75.0, 90.0}) {
    const double speed = course(neck, settings, 500, 2, [&](double) { return toward(yaw, 0); }).peak_speed;
    EXPECT_GT(speed, before);
    before = speed;
  }
  EXPECT_LT(before, settings.pace.rate);
}

TEST_F(Heads, HaveTheSameStatesAtEveryTickRate) {
  // a target that jumps at 0.5 s and 1 s, both on ticks of all rates
  const auto seen = [](double time) {
    if (time <= 0.5 + 1e-9) return toward(50, 10);
    return time <= 1 + 1e-9 ? toward(-80, -20) : toward(10, 5, 0.4);
  };
  const Course slow = course(neck, settings, 30, 2, seen);
  for (const double rate : {60.0, 90.0, 144.0, 1000.0}) {
    const Course fast = course(neck, settings, rate, 2, seen);
    ASSERT_EQ(fast.control.state.steps, slow.control.state.steps);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(fast.control.state.motion.lag[i], slow.control.state.motion.lag[i]) << rate;
    EXPECT_EQ(fast.last.posture, slow.last.posture) << rate;
  }
}

TEST_F(Heads, FollowMotionAlikeAtEveryTickRate) {
  settings.part = Part::full;
  const auto seen = [](double time) { return toward(40 * std::sin(2 * time), 10 * std::cos(3 * time)); };
  const Vector3d reference = course(neck, settings, 1000, 3, seen).last.posture;
  // linear interpolation of a 2 rad/s sine of 40 degrees over 1/30 s: 40 deg * 4 / 8 / 900 = 0.022 deg
  for (const double rate : {30.0, 60.0, 144.0})
    EXPECT_LT((course(neck, settings, rate, 3, seen).last.posture - reference).norm(), 0.03 * degree);
}

struct Path {
  const char* name;
  std::function<Sight(double)> seen;
};

// where heads of other makes flip: through the pole of ZYZ, round the head, overhead, behind, half a turn at once,
// between the eyes, along the axis
const Path atlas[] = {
    {"past_the_pole", [](double t) { return toward(-60 + 40 * t, 0.06); }},
    {"through_the_pole", [](double t) { return toward(-60 + 40 * t, 0); }},
    {"round_the_head", [](double t) { return toward(120 * t, 5); }},
    {"overhead",
     [](double t) {
       return at({0.001, 0.17 + 2 * std::cos(1.2 * t - 1.5), 0.1 + 2 * std::sin(1.2 * t - 1.5)});
     }},
    {"behind_and_back", [](double t) { return toward(180 + 14 * std::sin(5 * t), 3); }},
    {"half_turns", [](double t) { return toward(static_cast<int>(2 * t) % 2 ? 90 : -90, 0); }},
    {"up_and_down", [](double t) { return toward(0, static_cast<int>(2 * t) % 2 ? 89.9 : -89.9); }},
    {"between_the_eyes",
     [](double t) {
       return at({0, 0.1735, 0.4 - 0.2 * t});
     }},
    {"along_the_axis",
     [](double t) {
       return at({1e-9 * std::sin(99 * t), 0.17 + 1e-9 * std::cos(70 * t), 1});
     }},
    {"spiral", [](double t) { return toward(40 * t * std::cos(6 * t), 40 * t * std::sin(6 * t)); }},
};

class Atlas : public testing::TestWithParam<std::tuple<Part, Method>> {};

TEST_P(Atlas, KeepsLimitsAndRatesOnEveryPath) {
  const Neck neck = full_neck();
  Settings settings;
  settings.part = std::get<0>(GetParam());
  settings.method = std::get<1>(GetParam());
  std::vector<double> now(24), before(24);
  for (const Path& path : atlas) {
    Control control;
    neck.spread({0, 0, 0}, before.data());
    for (int n = 1; n <= 4 * 60; ++n) {
      const Control::Report report = control.tick(neck, settings, n / 60.0, 1 / 60.0, path.seen(n / 60.0), false);
      ASSERT_TRUE(report.posture.allFinite()) << path.name << " " << n;
      ASSERT_LE(neck.tilt(report.posture), 1 + 1e-12) << path.name;
      ASSERT_LE(neck.turn(report.posture), 1 + 1e-12) << path.name;
      neck.spread(report.posture, now.data());
      for (int j = 0; j < 24; ++j) {
        const Level& level = neck.levels()[j / 3];
        ASSERT_GE(now[j], level.lower[j % 3]);
        ASSERT_LE(now[j], level.upper[j % 3]);
        // the rate of a total times the largest share of the joint, with a tick's worth of rounding
        const double share =
            std::max(level.upper[j % 3] / neck.highest()[j % 3], level.lower[j % 3] / neck.lowest()[j % 3]);
        ASSERT_LE(std::abs(now[j] - before[j]), share * settings.pace.rate / 60 + 1e-12) << path.name << " joint " << j;
      }
      before = now;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(, Atlas,
                         testing::Combine(testing::Values(Part::human, Part::full),
                                          testing::Values(Method::swing_twist, Method::paper_zyz)));

// 0.06 degrees beside straight ahead the printed rule's alpha swings through half a turn; ours goes straight on
TEST_F(Heads, GoThroughThePoleSmoothly) {
  settings.part = Part::full;
  const Course done = course(neck, settings, 60, 3, atlas[0].seen);
  EXPECT_EQ(done.last.status, Status::moving);
  // 40 deg/s at 60 Hz is 0.67 deg a tick; the shift into motion at the beginning is faster
  Course middle = course(neck, settings, 60, 1.2, atlas[0].seen);
  for (int n = 73; n < 110; ++n) {
    const Vector3d before = middle.last.posture;
    middle.last = middle.control.tick(neck, settings, n / 60.0, 1 / 60.0, atlas[0].seen(n / 60.0), false);
    EXPECT_LT((middle.last.posture - before).norm(), 0.75 * degree);
  }
}

TEST_F(Heads, StayOnTheirSideForATargetBehind) {
  settings.part = Part::full;
  Control control;
  for (int n = 1; n <= 600; ++n) {
    const double t = n / 60.0;
    const double yaw = t < 3 ? 50 * t : 180 + 14 * std::sin(5 * t);
    const Control::Report report = control.tick(neck, settings, t, 1 / 60.0, toward(yaw, 2), false);
    if (t > 4) {
      EXPECT_GT(report.posture[axial], 60 * degree);
      EXPECT_EQ(report.limit == Limit::axial || report.limit == Limit::both, true);
    }
  }
  // and turn round when it comes back on the other side
  Control::Report report;
  for (int n = 601; n <= 800; ++n) report = control.tick(neck, settings, n / 60.0, 1 / 60.0, toward(-150, 2), false);
  EXPECT_LT(report.posture[axial], -60 * degree);
  EXPECT_EQ(report.status, Status::limited);
}

TEST_F(Heads, SayWhenATargetIsTooNearToHaveADirection) {
  const Vector3d eye = eyes(neck, settings, {0, 0, 0});
  const Course done = course(neck, settings, 60, 2, [&](double) { return at(eye + Vector3d(0, 0.01, 0)); });
  EXPECT_EQ(done.last.status, Status::too_near);
}

TEST_F(Heads, ReportTheLimitThatStopsThem) {
  settings.part = Part::full;
  EXPECT_EQ(course(neck, settings, 60, 4, [](double) { return toward(120, 0); }).last.limit, Limit::axial);
  EXPECT_EQ(course(neck, settings, 60, 4, [](double) { return toward(0, -85); }).last.limit, Limit::tilt);
  const Course fine = course(neck, settings, 60, 4, [](double) { return toward(40, 0); });
  EXPECT_EQ(fine.last.limit, Limit::none);
}

TEST_F(Heads, ComeBackWhenNothingIsLookedAt) {
  settings.part = Part::full;
  const Course done = course(neck, settings, 60, 5, [](double time) { return time < 2 ? toward(50, 20) : Sight{}; });
  EXPECT_EQ(done.last.status, Status::idle);
  EXPECT_LT(done.last.posture.norm(), 1e-9);
}

TEST_F(Heads, FaceASurface) {
  const Vector3d normal = direction({200 * degree, -10 * degree});
  const Course done = course(neck, settings, 60, 3, [&](double) {
    return Sight{Sight::orientation, Vector3d(0, 0, 1), normal};
  });
  EXPECT_EQ(done.last.status, Status::reached);
  EXPECT_LE((neck.rotation(done.last.posture).col(2) + normal).norm(), 1e-9);
}

TEST_F(Heads, DoWhatTheEyesSay) {
  settings.part = Part::eyes;
  settings.wish = {25 * degree, -15 * degree};
  const Course done = course(neck, settings, 60, 3, [](double) { return toward(70, 0); });
  EXPECT_LE((neck.rotation(done.last.posture).col(2) - direction(settings.wish)).norm(), 1e-9);
}

TEST_F(Heads, KeepTheirOnsetWhenTheTargetJumpsAgainAndAgain) {
  // a target that jumps every 100 ms would otherwise be waited for for ever
  const Course done =
      course(neck, settings, 60, 1, [](double time) { return toward(static_cast<int>(10 * time) % 2 ? 60 : 70, 0); });
  EXPECT_GT(done.last.posture[axial], 30 * degree);
}

// a head whose own frame is tilted against the neck's, as figures may have it
TEST_F(Heads, MindTheHeadsOwnFrame) {
  settings.part = Part::full;
  settings.head_at_rest = Eigen::AngleAxisd(0.2, Vector3d::UnitX()).toRotationMatrix();
  const Course done = course(neck, settings, 60, 3, [](double) { return toward(30, 5); });
  EXPECT_EQ(done.last.status, Status::reached);
  EXPECT_LT(done.last.gaze_error, 2e-7);
}

}  // namespace
}  // namespace head
