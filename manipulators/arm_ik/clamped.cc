#include "manipulators/arm_ik/clamped.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace arm_ik {

namespace {

// of the squared length of a typical column, so that it scales with the chain
constexpr double damping_share = 1e-3;
// steps this small [rad or m] are standstill
constexpr double standstill = 1e-12;

}  // namespace

Solution clamped_least_squares(const Solver& solver, const Goal& goal, const SolveOptions& options, double rate,
                               std::span<double> q) {
  const Packed& chain = solver.packed();
  const kinematics::Pose wanted = goal.target();
  const int rows = goal.pose ? 6 : 3;
  const double damping = damping_share * chain.length * chain.length;
  const int most = std::max(1, static_cast<int>(std::min(1e6, options.budget / nominal_step_time(chain.n))));
  for (int i = 0; i < chain.n; ++i) q[i] = std::clamp(q[i], chain.lower[i], chain.upper[i]);

  Solution out;
  out.method = Method::clamped;
  out.starts = 1;
  bool moved = true;
  while (true) {
    const kinematics::Pose at = kinematics::forward(solver.chain(), q);
    Eigen::Matrix<double, 6, 1> e;
    e.head<3>() = wanted.p - at.p;
    e.tail<3>() = goal.pose ? kinematics::rotation_vector(wanted.R * at.R.transpose()) : Eigen::Vector3d::Zero();
    out.position_error = e.head<3>().norm();
    out.rotation_error = e.tail<3>().norm();
    if (out.position_error <= options.position_tolerance && out.rotation_error <= options.rotation_tolerance) {
      out.status = Status::reached;
      return out;
    }
    if (!moved || out.iterations >= most) break;
    ++out.iterations;
    Eigen::MatrixXd J = kinematics::jacobian(solver.chain(), q).topRows(rows);
    if (goal.pose) {
      J.bottomRows<3>() *= chain.length;
      e.tail<3>() *= chain.length;
    }
    Eigen::MatrixXd A = J * J.transpose();
    A.diagonal().array() += damping;
    const Eigen::VectorXd dq = J.transpose() * A.ldlt().solve(e.head(rows));
    moved = false;
    for (int i = 0; i < chain.n; ++i) {
      const double next = std::clamp(q[i] + std::clamp(dq[i], -rate, rate), chain.lower[i], chain.upper[i]);
      moved = moved || std::abs(next - q[i]) > standstill;
      q[i] = next;
    }
  }
  out.status = moved ? Status::budget : solver.status_of_nearest(goal, q);
  return out;
}

}  // namespace arm_ik
