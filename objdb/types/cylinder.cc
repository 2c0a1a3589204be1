#include <string_view>

namespace objdb::types {

extern const std::string_view cylinder;
const std::string_view cylinder = R"~(
type cylinder extends shape "a rod about its origin, along y"
field cylinder.radius real m = 0.05 in 0 1e6 "of its round"
field cylinder.length real m = 0.1 in 0 1e6 "from end to end"
)~";

}  // namespace objdb::types
