#pragma once

#include <span>

#include "manipulators/eye_control/parameters.h"

namespace eye {

/// What a method is known to cost and to be worth.
struct MethodRow {
  Method method;
  double error;  ///< root mean square angle to the gaze of `full` over the standard course, rad
  double cost;   ///< processor time of one figure and internal step, s; of the machine it was measured on
};

/// From cheap to complete, as `eye_control --chart` measured them (methods.csv). Errors come out alike on every machine
/// (a test measures them again); costs are what a choice is made by, never what a result depends on otherwise.
std::span<const MethodRow> method_table();
const MethodRow& row_of(Method method);

/// The error of a method as the table has it, measured anew: jumps of up to 30 deg, sums of sines, ramps, a near
/// target, a turning head; 60 s.
double measured_error(Method method);

/// The cost of a method as the table has it, measured anew: 64 figures on the same course.
double measured_cost(Method method);

/// What one figure costs in a tick of `steps` internal steps, s: the method, and what is heard and told of it.
double tick_cost(Method method, double steps);

/// The cheapest method with at most this error, rad; `full` if none of the cheaper ones will do.
Method within_error(double error);

/// The most accurate method with which `figures` figures take at most this time for a tick of `steps` internal steps,
/// s; `snap` if none does.
Method within_time(double time, size_t figures, double steps);

}  // namespace eye
