#include <string_view>

namespace objdb::types {

extern const std::string_view sphere;
const std::string_view sphere = R"~(
type sphere extends shape "a ball about its origin"
field sphere.radius real m = 0.05 in 0 1e6 "from the centre to the surface"
)~";

}  // namespace objdb::types
