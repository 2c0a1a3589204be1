#pragma once

#include <cstdlib>
#include <optional>
#include <string>

#include "manipulators/mesh/read.h"

// The heads that faces are tried on; each is absent where its file is.
namespace face::heads {

inline std::optional<mesh::Surface> read(const std::string& path, double unit) {
  auto surface = mesh::read_surface(path);
  if (!surface) return std::nullopt;
  surface->V *= float(unit);
  return *surface;
}

/// Path in the folder of reference data, whose place SAILOR_DATA gives.
inline std::string data(const std::string& file) {
  const char* folder = std::getenv("SAILOR_DATA");
  return (folder != nullptr ? std::string(folder) : std::string(SOURCE_DIR) + "/../shared/data") + "/" + file;
}

/// The sailor's body, from Debian's assimp-testmodels.
inline std::optional<mesh::Surface> sailor() { return read("/usr/share/assimp/models/Collada/human.zae", 1); }
/// ICT-FaceKit's neutral head, centimetres.
inline std::optional<mesh::Surface> ict() { return read(data("head/ict/generic_neutral_mesh.obj"), 0.01); }
/// MakeHuman's base mesh, decimetres.
inline std::optional<mesh::Surface> makehuman() { return read(data("head/makehuman/base.obj"), 0.1); }

}  // namespace face::heads
