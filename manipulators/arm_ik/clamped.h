#pragma once

#include "manipulators/arm_ik/solver.h"

namespace arm_ik {

/// Damped least squares with fixed damping, joints clamped and no step above `rate` [rad or m a step]: the textbook
/// loop (Wampler 1986, Nakamura and Hanafusa 1986), slow and steady, kept as the reference that the other methods are
/// measured against. From q, at most budget / nominal_step_time steps.
Solution clamped_least_squares(const Solver& solver, const Goal& goal, const SolveOptions& options, double rate,
                               std::span<double> q);

}  // namespace arm_ik
