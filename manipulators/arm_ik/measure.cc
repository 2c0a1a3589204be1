#include "manipulators/arm_ik/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "manipulators/arm_ik/cpu_clock.h"

namespace arm_ik {

namespace {

using kinematics::Chain;
using kinematics::Pose;

constexpr double position_tolerance = 1e-5, rotation_tolerance = 1e-4;
// numbers that were written into a file and read back may lie this far outside a limit
constexpr double limit_slack = 1e-12;

/// Times one call [us]: the lesser of wall and processor time. Reading the processor's clock costs a third of a
/// microsecond that the wall clock has not; preemption costs the wall clock milliseconds that the other has not.
class Stopwatch {
 public:
  double elapsed() const {
    const double wall = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - wall_).count();
    return std::min(wall, 1e6 * (cpu_seconds() - cpu_));
  }

 private:
  double cpu_ = cpu_seconds();
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
};

double quantile(std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

bool inside(const Chain& chain, std::span<const double> q) {
  for (int i = 0; i < chain.size(); ++i) {
    if (!(q[i] >= chain.joints[i].lower - limit_slack && q[i] <= chain.joints[i].upper + limit_slack)) return false;
  }
  return true;
}

struct Errors {
  double position, rotation;
};

Errors errors(const Chain& chain, const Pose& target, std::span<const double> q) {
  const Pose at = kinematics::forward(chain, q);
  return {(at.p - target.p).norm(), kinematics::rotation_distance(at.R, target.R)};
}

double largest_change(std::span<const double> a, std::span<const double> b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

void summarize(std::vector<double>& times, TrackScore& score) {
  std::sort(times.begin(), times.end());
  score.median = quantile(times, 0.5);
  score.p99 = quantile(times, 0.99);
}

}  // namespace

Score measure(const Chain& chain, const std::vector<Problem>& problems, const Contestant& contestant, double position,
              double rotation, int passes) {
  Score score;
  score.targets = static_cast<int>(problems.size());
  std::vector<double> times(problems.size(), HUGE_VAL), places, turns;
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t k = 0; k < problems.size(); ++k) {
      std::vector<double> q = problems[k].start;
      const Stopwatch watch;
      contestant.solve(problems[k].target, position, rotation, q);
      times[k] = std::min(times[k], watch.elapsed());
      if (pass > 0) continue;
      const Errors left = errors(chain, problems[k].target, q);
      const bool solved = inside(chain, q) && left.position <= position && left.rotation <= rotation;
      if (!solved) ++score.failed;
      places.push_back(left.position);
      turns.push_back(left.rotation);
    }
  }
  std::sort(times.begin(), times.end());
  std::sort(places.begin(), places.end());
  std::sort(turns.begin(), turns.end());
  score.median = quantile(times, 0.5);
  score.p99 = quantile(times, 0.99);
  score.worst = quantile(times, 1);
  score.median_position = quantile(places, 0.5);
  score.median_rotation = quantile(turns, 0.5);
  return score;
}

TrackScore track(const Chain& chain, int courses, std::uint64_t seed, const std::function<Follower(double)>& make) {
  TrackScore score;
  std::vector<double> times;
  for (int number = 0; number < courses; ++number) {
    const Course course(chain, lap, seed + static_cast<std::uint64_t>(number));
    const double course_step = course.largest_step();
    const Follower follower = make(course_step);
    std::vector<double> q = course.posture(0), first_lap;
    for (int settle = 0; settle < 2 * lap; ++settle) follower.tick(kinematics::forward(chain, course.posture(0)), q);
    for (int t = 1; t <= laps * lap; ++t) {
      const Pose target = kinematics::forward(chain, course.posture(t));
      const std::vector<double> before = q;
      const Stopwatch watch;
      follower.tick(target, q);
      times.push_back(watch.elapsed());
      ++score.ticks;
      const Errors left = errors(chain, target, q);
      if (!inside(chain, q) || left.position > position_tolerance || left.rotation > rotation_tolerance) ++score.failed;
      const double step = largest_change(q, before);
      score.largest_step = std::max(score.largest_step, step);
      // rounding of the rate bound is no jump
      if (step > 2 * course_step * (1 + 1e-9)) ++score.jumps;
      if (t == lap) first_lap = q;
    }
    score.drift = std::max(score.drift, largest_change(q, first_lap));
  }
  summarize(times, score);
  return score;
}

TrackScore out_and_back(const Chain& chain, int courses, std::uint64_t seed, const Follower& follower) {
  constexpr double outwards = 0.8;  // [m]
  constexpr double largest_allowed = 0.1;
  TrackScore score;
  std::vector<double> times;
  for (int number = 0; number < courses; ++number) {
    const Course course(chain, lap, seed + static_cast<std::uint64_t>(number));
    std::vector<double> q = course.posture(0), first_lap;
    const Pose home = kinematics::forward(chain, q);
    for (int settle = 0; settle < 2 * lap; ++settle) follower.tick(home, q);
    for (int t = 1; t <= laps * lap; ++t) {
      Pose target = home;
      // out and back in the middle of the lap, at rest in its first and last fifth
      const double phase = std::clamp((static_cast<double>(t % lap) / lap - 0.2) / 0.6, 0.0, 1.0);
      target.p += (home.p - chain.base.p).normalized() * outwards * 0.5 * (1 - std::cos(2 * M_PI * phase));
      const std::vector<double> before = q;
      const Stopwatch watch;
      follower.tick(target, q);
      times.push_back(watch.elapsed());
      ++score.ticks;
      const double step = largest_change(q, before);
      score.largest_step = std::max(score.largest_step, step);
      if (step > largest_allowed * (1 + 1e-9)) ++score.jumps;
      if (t % lap == 0) {
        const Errors left = errors(chain, target, q);
        if (!inside(chain, q) || left.position > position_tolerance || left.rotation > rotation_tolerance)
          ++score.failed;
      }
      if (t == lap) first_lap = q;
    }
    score.drift = std::max(score.drift, largest_change(q, first_lap));
  }
  summarize(times, score);
  return score;
}

}  // namespace arm_ik
