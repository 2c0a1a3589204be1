#pragma once

#include <string>

#include "objdb/result.h"

namespace manager {

/// Where a script lies: as named from the current folder, `beside` the script that asks, or among the installed scenes
/// and figures (share/virtual_sailor beside the programs, or scripts/ of the source tree). Errors: io.
objdb::Result<std::string> find_script(const std::string& name, const std::string& beside,
                                       const std::string& program_folder);

/// The text of a file, a pipe or a device. Errors: io.
objdb::Result<std::string> read_script(const std::string& path);

}  // namespace manager
