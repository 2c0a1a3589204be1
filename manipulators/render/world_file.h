#pragma once

#include <string>

#include "objdb/database.h"

namespace render {

/// Reads a saved world (lines `type field create set`, as `save` writes them; other verbs are skipped) into `world`.
/// Returns an empty string, or FILE:LINE:COLUMN: error KIND sentence.
std::string read_world(const std::string& path, objdb::Database& world);

/// Reads a declaration text: `type` and `field` lines count, others are skipped.
std::string declare_types(std::string_view text, objdb::Database& world);

}  // namespace render
