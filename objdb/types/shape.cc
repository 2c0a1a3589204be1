#include <string_view>

namespace objdb::types {

extern const std::string_view shape;
const std::string_view shape = R"~(
type shape extends node "a node with something to be seen"
field shape.color vec3 = 0.8 0.8 0.8 in 0 1 "red green blue, sRGB"
field shape.opacity real = 1 in 0 1 "1 hides what is behind"
field shape.shininess real = 0.2 in 0 1 "0 is chalk, 1 is polished"
)~";

}  // namespace objdb::types
