#pragma once

#include <span>

#include "manipulators/arm_ik/human_arm.h"
#include "manipulators/arm_ik/solver.h"

namespace arm_ik {

/// Closed form for the arm below a girdle that is given: the elbow from the wrist's distance, the humerus as the least
/// turn from its rest orientation that brings the wrist to the target (which fixes the swivel angle, and makes the
/// posture a function of the target alone), the three shoulder angles from that orientation. Elbow and forearm axes are
/// skew and offset; they are treated exactly. After Tolani, Goswami and Badler (2000) and Kallmann (2008).
class Limb {
 public:
  /// Girdle and forearm turn are those of `posture` (11); the humerus's rest orientation is the chain's.
  Limb(const HumanArm& arm, std::span<const double> posture);

  struct Answer {
    double q[4];     ///< the three shoulder angles and the elbow [rad]
    double excess;   ///< largest violation of their limits [rad], 0 inside
    bool reachable;  ///< false: the target is nearer or farther than the elbow allows; the wrist points at it
  };

  /// One target, position of the wrist in the chain's surroundings; `swivel` turns the elbow about the line from
  /// shoulder to target, 0 is the least turn. About 0.1 us.
  Answer solve(const Eigen::Vector3d& target, double swivel = 0) const;

  /// Eight targets, x y z in rows of eight; the same bits as `solve` of each. About 25 ns a target.
  void solve_eight(const double* targets, Answer* answers, Isa isa = best_isa()) const;

  /// The answer within the limits with the least swivel out of `samples` evenly spaced, or the one with the least
  /// excess.
  Answer solve_within_limits(const Eigen::Vector3d& target, int samples = 32) const;

  /// Everything the closed form needs, in plain numbers.
  struct Constants {
    double center[3];         // glenohumeral centre
    double to_socket[9];      // rows: surroundings to the first shoulder joint's frame
    double reference[9];      // rows: humerus frame at rest to the surroundings
    double upper_arm[3];      // humerus frame: shoulder to the elbow frame
    double elbow_c, elbow_s;  // tilt of the elbow axis
    double forearm[3];        // elbow frame after the turn: to the wrist
    double mean, swing;       // wrist distance squared = mean + swing * cos(elbow - phase)
    double phase_c, phase_s;
    double branch;  // +1 or -1: which of the two elbow angles
    double offset[4], lower[4], upper[4], middle[4];
  };

 private:
  Constants constants_;
};

/// The method: girdle by rhythm (`rhythm_girdle`) or as it is in q, wrist by closed form, forearm turned to the wanted
/// orientation as far as that goes. q: 11 joints, girdle read (unless by rhythm), all written.
Solution solve_limb(const HumanArm& arm, const Goal& goal, const SolveOptions& options, bool rhythm_girdle,
                    std::span<double> q);

}  // namespace arm_ik
