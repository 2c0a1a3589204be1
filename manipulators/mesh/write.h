#pragma once

#include <string>

#include "manipulators/mesh/result.h"
#include "manipulators/mesh/surface.h"

namespace mesh {

/// Writes `surface` as OBJ (one `g` group per part), binary PLY (with the part of each face), binary STL or
/// binary glTF, by the ending of `path` (.obj .ply .stl .glb). Returns the number of bytes written.
/// Errors: `io` file cannot be written, `unknown` ending, `range` surface that breaks its invariants.
Result<std::size_t> write_surface(const std::string& path, const Surface& surface);

}  // namespace mesh
