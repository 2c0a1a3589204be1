#include "manipulators/head_ik/motion.h"

#include <cmath>

namespace head {

void advance(Motion* motion, const Eigen::Vector3d& goal, const Pace& pace, double h) {
  const Eigen::Vector3d way = goal - motion->paced;
  const double length = way.norm(), allowed = pace.rate * h;
  motion->paced = length <= allowed ? goal : Eigen::Vector3d(motion->paced + allowed / length * way);

  // the matrix exponential of three equal lags in a row: exp(-u) times 1, u, u^2/2, the input takes what is left to 1
  const double u = h / pace.lag, e = std::exp(-u), e1 = u * e, e2 = 0.5 * u * e1;
  const Eigen::Vector3d& r = motion->paced;
  auto& [a, b, c] = motion->lag;
  c = e * c + e1 * b + e2 * a + (1 - e - e1 - e2) * r;
  b = e * b + e1 * a + (1 - e - e1) * r;
  a = e * a + (1 - e) * r;
}

}  // namespace head
