#pragma once

#include <string>

#include "manipulators/face_fem/error.h"
#include "manipulators/mesh/surface.h"

namespace face {

/// Reads a cylindrical range scan in the legacy VTK text format: a grid of angles by heights round the y axis, metres,
/// as STRUCTURED_GRID with DIMENSIONS or as POLYDATA with POLYGONS of three or four corners. The face may look
/// anywhere: the scan is turned about y so that its nose (the largest radius of the middle third of its height) points
/// to +Z, and its faces so that they look outward. Further data of the file are skipped. Errors: `io`, `syntax`
/// FILE:LINE, `truncated`, `not_finite`, `unknown` a corner that is no point.
Result<mesh::Surface> read_range_scan(const std::string& path);

/// The same from text; `name` stands for the file in errors.
Result<mesh::Surface> parse_range_scan(const std::string& text, const std::string& name);

}  // namespace face
