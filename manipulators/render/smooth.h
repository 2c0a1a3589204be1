#pragma once

#include "manipulators/render/picture.h"

namespace render {

/// Antialiasing of a finished picture: finds edges in brightness and blends each pixel with its neighbour across the
/// edge by how far the edge has run, after the fast approximate method of T. Lottes (2009). Alpha is kept.
/// Runs on the processor because most pixels have no edge, and only there is skipping them free.
void smooth_edges(Picture& picture);

}  // namespace render
