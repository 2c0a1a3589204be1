#pragma once

#include <string>
#include <vector>

#include "manipulators/mesh/result.h"

namespace mesh {

/// The file that `name` means: absolute names as they are; others in the current folder, then in each folder of the
/// environment variable SAILOR_SCENES (colon-separated), then among the installed scenes.
/// Error `io` names every place looked at.
Result<std::string> find_file(const std::string& name);

}  // namespace mesh
