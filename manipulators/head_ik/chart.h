#pragma once

#include <string>

namespace head {

/// head_ik --chart DIR: measures what the charts of the head show and writes it as CSV files into DIR (made when
/// absent).
///   zyz_error.csv   method, noise, pole, distance_rad, largest_error_rad, median_error_rad
///   zyz_time.csv    method, noise, pole, distance_rad, time_ns (processor time)
///   zyz_pass.csv    a gaze that passes the pole at 1e-3 rad: angles of the ZYZ rule against the joints of the neck
///   reach.csv       over gaze directions: errors of the paper's rule and ours
///   share.csv       head and eye parts of a gaze shift; shift.csv their course in time; speed.csv the main sequence
///   solve.csv       error and time of the neck's solver by distance from its limits
/// Random numbers come from mt19937_64 with fixed seeds. Exit status 0, or 1 with one line on standard error.
int chart_command(const std::string& folder);

}  // namespace head
