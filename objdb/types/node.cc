#include <string_view>

namespace objdb::types {

extern const std::string_view node;
const std::string_view node = R"~(
type node "a place in the world: right-handed, Y up, +Z forward, relative to its parent"
field node.parent ref:node "the node it moves with; without one, the nearest node above it in its path"
field node.position vec3 m "origin of its frame in the parent's frame"
field node.orientation quat "rotation of its frame in the parent's frame, w x y z"
field node.scale vec3 = 1 1 1 in 1e-6 1e6 "of its own drawing along its axes; children do not inherit it"
field node.visible bool = true "drawn or not, it and everything below it"
field node.world_position vec3 m derived "origin of its frame in the world"
field node.world_orientation quat derived "rotation of its frame in the world, w x y z, w >= 0"
)~";

}  // namespace objdb::types
