#include "manipulators/eye_control/crowd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Many figures side by side: the bits of each are those of one alone, which is compiled without wide registers.
namespace eye::test {
namespace {

template <class State>
uint64_t bits(const State& state) {
  uint64_t hash = 1469598103934665603u;
  for (const auto& [name, row] : state) {
    for (double x : row) {
      uint64_t word;
      std::memcpy(&word, &x, sizeof word);
      hash = (hash ^ word) * 1099511628211u;
    }
  }
  return hash;
}

// a course of figure `k`: no two do the same at the same time
void course(FollowingWorld& world, int k) {
  const double f = 0.3 + 0.13 * k, delay = 0.17 * k;
  for (int n = -200; n <= 4000; ++n) {
    const double t = n / 1000.0, local = t - delay;
    double azimuth = local < 0.3 ? 0 : local < 1.0 ? 10 - 2 * k : 12 * std::sin(2 * pi * f * local);
    if (k == 5 && t > 2) azimuth = 75;  // beyond the eyes' range
    const bool hidden = k == 3 && t > 2.2 && t < 2.6;
    world.target_track().add(t, {azimuth * deg, 4 * std::sin((1 + k) * t) * deg, k % 3 == 1 && t > 0.8 ? 2.5 : 0},
                             !hidden);
    const double head = k % 2 == 0 ? 0 : 8 * std::sin((3 + k) * t);
    world.head_track().add(t, {head * deg, 0.4 * head * deg, 0});
  }
}

Parameters everything() {
  Parameters p;
  p.later_sigma = 1;
  p.drift_speed = 0.2 * deg;
  p.microsaccade_rate = 1.5;
  p.blink_rate = 0.5;
  p.slip_noise = 0.1 * deg;
  return p;
}

TEST(Crowd, EachOfEightHasTheBitsOfOneAlone) {
  Parameters slow = everything();
  slow.visual_lag = 0.02, slow.plant_estimate = 0.9, slow.integrator_time = 5, slow.vergence_copy_gain = 0.6;
  Parameters linear = everything(), saccades = everything(), snap = everything();
  linear.method = Method::linear, saccades.method = Method::saccade_only, snap.method = Method::snap;
  for (const Parameters& p : {Parameters{}, everything(), slow, linear, saccades, snap}) {
    Gazes<8> eight(std::make_shared<Parameters>(p));
    std::vector<FollowingWorld> worlds(8);
    std::vector<std::unique_ptr<Gaze>> alone;
    eight.start(-100);
    for (int k = 0; k < 8; ++k) {
      course(worlds[static_cast<size_t>(k)], k);
      auto own = std::make_shared<Parameters>(p);
      own->seed = 11 * k;
      alone.push_back(std::make_unique<Gaze>(own));
      alone.back()->rest({}, -100);
      eight.rest(static_cast<size_t>(k), {}, static_cast<uint64_t>(11 * k));
    }
    Stimulus met[8];
    for (int n = -100; n < 3900; ++n) {
      for (size_t k = 0; k < 8; ++k) {
        met[k] = stimulus(worlds[k], *alone[k]);
        alone[k]->advance(met[k]);
      }
      eight.advance(met);
      if (n % 97 != 0) continue;
      for (size_t k = 0; k < 8; ++k) {
        ASSERT_EQ(bits(eight.save(k)), bits(alone[k]->save())) << word(p.method) << ", figure " << k << ", step " << n;
        ASSERT_EQ(eight.mode(k), alone[k]->mode());
      }
    }
  }
  report("N2", "eight figures side by side have the bits of each alone, with all options on");
}

TEST(Crowd, WhatIsRememberedOfSightsChangesNoBit) {
  FollowingWorld world;
  course(world, 3);
  const auto p = std::make_shared<Parameters>(everything());
  Gaze remembering(p), forgetful(p);
  remembering.rest({}, -100), forgetful.rest({}, -100);
  Sighting sighting;
  for (int n = -100; n < 3900; ++n) {
    remembering.advance(stimulus(world, *p, p->eye_distance, n, remembering.aim(), sighting));
    forgetful.advance(stimulus(world, forgetful));
  }
  EXPECT_EQ(bits(remembering.save()), bits(forgetful.save()));
}

// somebody who looks at a course
struct Looker {
  FollowingWorld world;
  Crowd::Seat seat;
  explicit Looker(int k) { course(world, k); }
};

Stimulus meet(void* who, const Crowd::Table& table, size_t lane) {
  Sighting sighting;
  return stimulus(static_cast<Looker*>(who)->world, table.parameters(), 0.063, table.step(), table.aim(lane), sighting);
}

TEST(Crowd, ComingAndGoingOfOthersChangesNothing) {
  const Parameters p = everything();
  const auto last = [&](bool company) {
    Crowd crowd;
    Looker one(2);
    one.seat = crowd.seat(p, 0, &one);
    one.seat.rest({}, 5);
    std::vector<std::unique_ptr<Looker>> others;
    for (int tick = 1; tick <= 60; ++tick) {
      if (company && tick % 7 == 3) {
        others.push_back(std::make_unique<Looker>(tick % 8));
        Parameters q = p;
        // every other one sits elsewhere, since something is different about it
        if (tick % 2) q.pursuit_gain = 0.8;
        others.back()->seat = crowd.seat(q, 50 * (tick - 1), others.back().get());
        others.back()->seat.rest({}, 9);
      }
      if (company && tick % 13 == 0) others.erase(others.begin());
      crowd.advance(50 * tick, meet);
    }
    return bits(one.seat.save());
  };
  EXPECT_EQ(last(false), last(true));
}

TEST(Crowd, MovesAndGoesOnUnderOtherDelays) {
  // a longer delay than the state was saved with: the past before it is taken to have been as at its start
  Crowd crowd;
  Looker one(1);
  Parameters p;
  one.seat = crowd.seat(p, 0, &one);
  one.seat.rest({}, 1);
  crowd.advance(900, meet);
  const Aim before = one.seat.aim();
  const auto state = one.seat.save();
  for (double delay : {0.27, 0.02}) {
    p.visual_delay = p.copy_visual_delay = delay;
    Crowd::Seat next = crowd.seat(p, 900, &one);
    ASSERT_TRUE(next.restore(state, 1));
    EXPECT_EQ(next.aim().version, before.version);
    EXPECT_EQ(next.saccades(), one.seat.saccades());
    EXPECT_FALSE(crowd.seat(p, 901, &one).restore(state, 1)) << "a state of another time";
  }
}

TEST(Crowd, ALongRestLeavesNoSubnormalNumbers) {
  // what decays for ever ends in numbers that processors are slow with
  Gaze gaze(std::make_shared<Parameters>());
  FollowingWorld world = world_of({{0, 0}, {0.1, 0}, {1, 20}});
  for (int n = 0; n < 120000; ++n) gaze.advance(stimulus(world, gaze));
  for (const auto& [name, row] : gaze.save()) {
    for (double x : row) EXPECT_TRUE(x == 0 || std::isnormal(x)) << name << " " << x;
  }
}

}  // namespace
}  // namespace eye::test
