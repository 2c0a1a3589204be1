#pragma once

#include <string>

namespace arm_ik {

/// Writes the data of the arm's charts into `folder` (made when it is not there):
///   work_precision.csv  every method and every peer that was built, over tolerances and problem sets; failures are
///   rows place.csv           the methods of the human arm on places alone: share reached, what is missed, time
///   tracking.csv        closed courses and a target that leaves reach and comes back
///   out_and_back.csv    one such journey tick by tick
///   atlas.csv           the wrist's workspace in two planes through the shoulder, by model
/// About two minutes. The exit status: 0, or 1 when the folder cannot be written.
int chart(const std::string& folder);

}  // namespace arm_ik
