#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "manipulators/kinematics/chain.h"

namespace arm_ik {

/// Follows all ways at once, as a witness for those who follow one: a crowd of postures spread over everything that is
/// connected with a first posture and holds the same pose, inside the limits, goes along a course until none is left.
/// Shares nothing with the solvers but plain forward kinematics and its Jacobian: the null space is that of an
/// eigenvalue problem, steps are least squares with bounds by pivoting on the joints at limits. A course that it does
/// not get through may still be passable when the set has more dimensions than the crowd can fill; one that it gets
/// through is passable. Slow: a millisecond or more a tick.
class Ways {
 public:
  struct Options {
    double spacing = 0.05;  ///< between neighbours of the crowd, largest joint [rad]
    int most = 300;         ///< postures of the crowd; a one-dimensional set is covered whole by fewer
    int substeps = 8;       ///< of a tick, each corrected
    double leap = 0.15;     ///< a posture that must go farther than this in a substep [rad] has left its way
  };

  explicit Ways(const kinematics::Chain& chain) : Ways(chain, Options()) {}
  Ways(const kinematics::Chain& chain, const Options& options) : chain_(chain), options_(options) {}

  using Posture = Eigen::VectorXd;
  using Course = std::function<kinematics::Pose(double tick)>;

  /// Postures that hold the pose of the first one, each within `spacing` of another; `from` first.
  std::vector<Posture> connected(const std::vector<Posture>& from, const kinematics::Pose& pose) const;

  /// For how many ticks after `tick`, at most `most`, a crowd that starts connected with q goes on along the course.
  int goes_on(const Posture& q, const Course& course, int tick, int most) const;

  /// Brings q to the pose within the limits by Newton steps of least length; false when it does not come there.
  bool bring(Posture& q, const kinematics::Pose& pose) const;

 private:
  bool inside(const Posture& q) const;
  std::vector<Posture> directions(const Posture& q) const;

  const kinematics::Chain& chain_;
  Options options_;
};

}  // namespace arm_ik
