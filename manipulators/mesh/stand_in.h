#pragma once

#include <vector>

#include "manipulators/mesh/skin.h"

namespace mesh {

/// The figure drawn when no body file is there: a capsule along each bone (from, to, radius) in the bind pose, and a
/// modelled head (skull, brow, nose, lips, chin, ears) on the bone named `head` when there is one.
/// Closed parts, bound rigidly each to its bone, joints covered by the capsules' round ends.
Skin stand_in(const std::vector<Bone>& bones);

}  // namespace mesh
