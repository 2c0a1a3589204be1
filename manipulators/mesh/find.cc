#include "manipulators/mesh/find.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace mesh {
namespace {

/// The folders where scenes and figures are installed, as seen from the running program: beside it in an installed
/// tree, or in the source tree that its build folder lies in.
std::vector<std::filesystem::path> installed_folders() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  std::vector<std::filesystem::path> folders;
  if (!failure) {
    for (const char* scripts : {"../share/virtual_sailor", "../../../scripts"}) {
      folders.push_back((program.parent_path() / scripts).lexically_normal());
    }
  }
#ifdef SCRIPTS_DIR
  folders.emplace_back(SCRIPTS_DIR);
#endif
  return folders;
}

}  // namespace

Result<std::string> find_file(const std::string& name) {
  namespace fs = std::filesystem;
  std::vector<fs::path> places = {name};
  if (fs::path(name).is_relative()) {
    if (const char* scenes = std::getenv("SAILOR_SCENES"); scenes != nullptr) {
      std::istringstream folders(scenes);
      for (std::string folder; std::getline(folders, folder, ':');) {
        if (!folder.empty()) {
          places.push_back(fs::path(folder) / name);
        }
      }
    }
    for (const fs::path& folder : installed_folders()) {
      for (const char* below : {"", "scenes", "figures"}) {
        places.push_back(folder / below / name);
      }
    }
  }

  std::error_code failure;
  std::string looked;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place, failure)) {
      return place.string();
    }
    looked += (looked.empty() ? "" : ", ") + place.string();
  }
  return Error{"io", "no file " + name + "; looked at " + looked};
}

}  // namespace mesh
