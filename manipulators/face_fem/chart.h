#pragma once

#include <string>

namespace face {

/// Measures elements, quadratures, frame methods, locking and large motion against their cost, and writes one CSV for
/// each into `folder` (created when absent): face_elements, face_quadrature, face_frames, face_locking,
/// face_nonlinear, and face_refusals with what is refused and how. Columns that end in _ms or _us are CPU time of this
/// machine; all others are the same on every run. What is refused or does not converge is a row with its status. About
/// two minutes. Returns the exit status.
int run_chart(const std::string& folder);

}  // namespace face
