#pragma once

#include <string>

#include "objdb/result.h"

namespace eye {

/// Measures everything that docs/charts shows of the eyes and writes it as CSV files into `folder`, which is created:
/// work_precision, stability_gain, stability_local, ramps, accelerations, sines, main_sequence, profiles, gaze_shift,
/// vergence. Only the column cpu_us_per_s of work_precision depends on the machine. Takes a few seconds. Error: io.
objdb::Status write_charts(const std::string& folder);

}  // namespace eye
