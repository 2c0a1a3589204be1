#pragma once

#include <string>
#include <vector>

#include "manipulators/mesh/figure/skeleton.h"
#include "manipulators/mesh/figure/uniform.h"

namespace figure {

/// A length or angle as it stands in a script: rounded to 1e-9, without trailing zeros, never -0.
std::string number(double value);

/// The lines `create node ...` and `create joint ...` of all parts but the neck's, parents before children; where the
/// neck belongs stands `source neck.dlg`. Angles in rad with the limits in degrees beside them as a comment.
std::string skeleton_script(const Skeleton& skeleton, const Landmarks& landmarks);

/// The lines `create bone`, `create skin`, `create garment` and `create mesh` that draw the body `file`.
std::string body_script(const Skeleton& skeleton, const Landmarks& landmarks, const std::string& file);

/// The lines that put eyes into the sockets and a gaze and a neck in charge of them.
std::string gaze_script(const Landmarks& landmarks);

}  // namespace figure
