#include <string_view>

namespace objdb::types {

extern const std::string_view camera;
const std::string_view camera = R"~(
type camera extends node "an eye of the renderer; it looks along its +Z"
field camera.field_of_view real rad = 0.7 in 0.01 3 "from the lower to the upper edge of the picture"
field camera.near real m = 0.05 in 1e-4 1e3 "nothing nearer is seen"
field camera.far real m = 100 in 1e-3 1e6 "nothing farther is seen"
field camera.target ref:node "what it looks at, whatever its own orientation"
)~";

}  // namespace objdb::types
