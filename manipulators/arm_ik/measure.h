#pragma once

#include <functional>
#include <string>
#include <vector>

#include "manipulators/arm_ik/peer.h"
#include "manipulators/arm_ik/problems.h"
#include "manipulators/arm_ik/solution.h"

namespace arm_ik {

/// A contestant: solves one target from q, which it overwrites.
struct Contestant {
  std::string name;
  std::function<void(const kinematics::Pose& target, double position_tolerance, double rotation_tolerance,
                     std::span<double> q)>
      solve;
  bool restarts_within_budget = false;  ///< slow enough that one pass and few targets do
};

/// What one contestant did with one set. Errors are judged by forward kinematics apart from every solver; an answer
/// outside the limits is a failure.
struct Score {
  int targets = 0, failed = 0;
  double median = 0, p99 = 0, worst = 0;            ///< time of a target [us], the least of the passes
  double median_position = 0, median_rotation = 0;  ///< [m], [rad] over all targets
};

/// Solves every problem `passes` times, far apart, and takes the least time of each: preemption and cold caches are
/// no property of a solver.
Score measure(const kinematics::Chain& chain, const std::vector<Problem>& problems, const Contestant& contestant,
              double position_tolerance, double rotation_tolerance, int passes);

/// A follower: one tick, q moves on.
struct Follower {
  std::string name;
  std::function<void(const kinematics::Pose& target, std::span<double> q)> tick;
};

struct TrackScore {
  int ticks = 0, failed = 0, jumps = 0;  ///< a jump: a joint steps more than twice as far as the course's largest step
  double largest_step = 0;               ///< [rad]
  double drift = 0;            ///< largest change of a joint from the end of the first lap to the end of the last [rad]
  double median = 0, p99 = 0;  ///< [us]
};

constexpr int lap = 500, laps = 4;  ///< ticks of 10 ms

/// `courses` closed courses of four laps (seeds from `seed` on) at 1e-5 m and 1e-4 rad; starts settled at the first
/// target.
TrackScore track(const kinematics::Chain& chain, int courses, std::uint64_t seed,
                 const std::function<Follower(double largest_step)>& make);

/// The target goes straight out of reach by 0.8 m and comes back, four times: `jumps` counts steps above 0.1 rad,
/// `failed` ticks at rest within reach that miss it, `drift` compares the postures at the ends of the laps.
TrackScore out_and_back(const kinematics::Chain& chain, int courses, std::uint64_t seed, const Follower& follower);

}  // namespace arm_ik
