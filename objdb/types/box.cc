#include <string_view>

namespace objdb::types {

extern const std::string_view box;
const std::string_view box = R"~(
type box extends shape "a block about its origin"
field box.size vec3 m = 0.1 0.1 0.1 in 0 1e6 "edge lengths along x y z"
)~";

}  // namespace objdb::types
