#pragma once

#include <string>
#include <vector>

#include "objdb/result.h"

namespace manager {

/// Where a script lies: as named from the current folder, `beside` the script that asks, or among the installed scenes
/// and figures (share/virtual_sailor beside the programs, or scripts/ of the source tree). Errors: io.
/// The path comes without turns (a/../b).
objdb::Result<std::string> find_script(const std::string& name, const std::string& beside,
                                       const std::string& program_folder);

/// Where the installed scenes and figures lie; some may not be there.
std::vector<std::string> script_folders(const std::string& program_folder);

/// The text of a file, a pipe or a device. Errors: io.
objdb::Result<std::string> read_script(const std::string& path);

}  // namespace manager
