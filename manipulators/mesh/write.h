#pragma once

#include <string>

#include "manipulators/mesh/result.h"
#include "manipulators/mesh/surface.h"

namespace mesh {

/// Writes `surface` as OBJ (one group per part), binary PLY, binary STL or binary glTF (one mesh per part), by the
/// ending of `path` (.obj .ply .stl .glb). Returns the number of bytes written. PLY and STL keep no parts, STL no
/// sharing of vertices. OBJ has nine significant digits: floats read back exactly. Errors: `io` file cannot be written,
/// `unknown` ending, `range` surface that breaks its invariants.
Result<std::size_t> write_surface(const std::string& path, const Surface& surface);

}  // namespace mesh
