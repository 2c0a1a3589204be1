// Plain forward kinematics and Jacobian of the kinematics library; the baseline is the same chain as a product of
// Eigen's isometries. The solvers' own vectorized kinematics are part of arm_ik_bench.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "manipulators/kinematics/arm11.h"

namespace {

using kinematics::Chain;

double nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

// least time of a call over passes; `sink` keeps the work alive
template <class Work>
double time_of(const std::vector<std::vector<double>>& postures, double& sink, Work work) {
  double least = HUGE_VAL;
  for (int pass = 0; pass < 20; ++pass) {
    const double before = nanoseconds();
    for (const std::vector<double>& q : postures) sink += work(q);
    least = std::min(least, (nanoseconds() - before) / static_cast<double>(postures.size()));
  }
  return least;
}

Eigen::Isometry3d isometries(const Chain& chain, const std::vector<double>& q) {
  const auto of = [](const kinematics::Pose& X) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = X.R;
    out.translation() = X.p;
    return out;
  };
  Eigen::Isometry3d X = of(chain.base);
  for (int i = 0; i < chain.size(); ++i) {
    const kinematics::Joint& joint = chain.joints[i];
    X = X * Eigen::AngleAxisd(joint.offset + q[i], Eigen::Vector3d::UnitZ()) * Eigen::Translation3d(joint.p) *
        Eigen::AngleAxisd(joint.alpha, Eigen::Vector3d::UnitX());
  }
  return X * of(chain.tool);
}

}  // namespace

int main() {
  const Chain chain = kinematics::arm11();
  std::mt19937_64 random(1);
  std::vector<std::vector<double>> postures(2000);
  for (auto& q : postures) {
    for (const kinematics::Joint& joint : chain.joints)
      q.push_back(std::uniform_real_distribution(joint.lower, joint.upper)(random));
  }
  double sink = 0, difference = 0;
  const double baseline =
      time_of(postures, sink, [&](const auto& q) { return isometries(chain, q).translation().x(); });
  const double forward = time_of(postures, sink, [&](const auto& q) { return kinematics::forward(chain, q).p.x(); });
  const double jacobian = time_of(postures, sink, [&](const auto& q) { return kinematics::jacobian(chain, q)(0, 0); });
  for (const auto& q : postures) {
    const kinematics::Pose X = kinematics::forward(chain, q);
    difference = std::max(difference, (isometries(chain, q).matrix().topRightCorner<3, 1>() - X.p).norm());
  }
  std::printf("eleven-freedom arm           ns a posture\n");
  std::printf("product of isometries (Eigen) %8.0f\n", baseline);
  std::printf("forward                       %8.0f\n", forward);
  std::printf("jacobian                      %8.0f\n", jacobian);
  std::printf("largest difference %.1e m%s\n", difference, std::isfinite(sink) ? "" : "!");
}
