#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "manipulators/kinematics/chain.h"

namespace arm_ik {

/// One target with a start and, when it was made from one, a posture that reaches it.
struct Problem {
  kinematics::Pose target;
  std::vector<double> start;
};

/// Kinds of targets, all drawn from seeded chance:
///   random       poses of postures anywhere in the limits; random start
///   warm         likewise; every joint of the start within 0.1 rad
///   near_limit   every joint stands at its lower or upper limit with a chance of one in four each
///   singular     stretched elbow, gimbal of the shoulder, or both (human arm); other chains: a random half of the
///                joints at 0 or the limit nearest to it
///   unreachable  random poses moved outwards beyond the sum of the links
enum class ProblemSet { random, warm, near_limit, singular, unreachable };
constexpr ProblemSet problem_sets[] = {ProblemSet::random, ProblemSet::warm, ProblemSet::near_limit,
                                       ProblemSet::singular, ProblemSet::unreachable};
std::string_view name_of(ProblemSet set);

std::vector<Problem> problems(const kinematics::Chain& chain, ProblemSet set, int count, std::uint64_t seed);

/// A closed course of postures that visits up to 95 % of every joint's range: `ticks` postures a lap, two harmonics a
/// joint, continued for any tick.
class Course {
 public:
  Course(const kinematics::Chain& chain, int ticks, std::uint64_t seed);
  std::vector<double> posture(int tick) const;
  /// The largest step of a joint from tick to tick.
  double largest_step() const;

 private:
  struct Wave {
    double middle, half, share, phase, second_phase;
    int harmonic, second_harmonic;
  };
  int ticks_;
  std::vector<Wave> waves_;
};

/// Well-known arms of other makes: KUKA LBR iiwa 14 (Denavit-Hartenberg) and Franka Panda (Craig's convention, flange),
/// from their makers' published values.
kinematics::Chain iiwa14();
kinematics::Chain panda();

}  // namespace arm_ik
