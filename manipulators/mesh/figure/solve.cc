#include "manipulators/mesh/figure/solve.h"

#include <Eigen/Cholesky>

namespace figure {

Eigen::VectorXd least_squares(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& residual,
                              Eigen::VectorXd start) {
  Eigen::VectorXd x = std::move(start);
  Eigen::VectorXd r = residual(x);
  double damping = 1e-3;
  for (int step = 0; step < 200; ++step) {
    Eigen::MatrixXd J(r.size(), x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      constexpr double h = 1e-6;
      const Eigen::VectorXd e = h * Eigen::VectorXd::Unit(x.size(), i);
      J.col(i) = (residual(x + e) - residual(x - e)) / (2 * h);
    }
    Eigen::MatrixXd A = J.transpose() * J;
    A.diagonal().array() += damping;
    const Eigen::VectorXd dx = -A.ldlt().solve(J.transpose() * r);
    const Eigen::VectorXd r_new = residual(x + dx);
    if (r_new.squaredNorm() < r.squaredNorm()) {
      x += dx;
      r = r_new;
      damping *= 0.1;
    } else {
      damping *= 10;
    }
    if (dx.norm() < 1e-13 || damping > 1e12) {
      break;
    }
  }
  return x;
}

}  // namespace figure
