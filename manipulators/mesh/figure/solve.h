#pragma once

#include <Eigen/Core>
#include <functional>

namespace figure {

/// Levenberg-Marquardt with central differences, for the few small fits of the figure (at most ten unknowns).
/// Returns the x that makes |residual(x)| least near `start`; stops when a step is below 1e-13 or after 200 steps.
Eigen::VectorXd least_squares(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& residual,
                              Eigen::VectorXd start);

}  // namespace figure
