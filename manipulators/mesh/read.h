#pragma once

#include <string>

#include "manipulators/mesh/result.h"
#include "manipulators/mesh/surface.h"

namespace mesh {

/// How a file becomes a surface.
struct ReadOptions {
  /// Vertices closer than this (metres) are the same vertex, so that texture seams and facets do not cut the surface.
  /// 0 keeps them as the file has them.
  double weld = 1e-6;
};

/// Reads OBJ, PLY, STL, Collada (.dae, .zae) and glTF (.gltf, .glb); the file's own unit and up axis are turned into
/// metres and Y up. Polygons become triangles, degenerate ones are dropped, normals are computed (normals.h), each
/// mesh of the file is one part. Errors: `io` missing or unreadable file, `syntax` broken or unknown format, `range`
/// NaN or infinite coordinates, no vertices, or no faces.
Result<Surface> read_surface(const std::string& path, const ReadOptions& options = {});

}  // namespace mesh
