#include <string_view>

namespace objdb::types {

extern const std::string_view capsule;
const std::string_view capsule = R"~(
type capsule extends shape "a rod with round ends about its origin, along y"
field capsule.radius real m = 0.05 in 0 1e6 "of its round"
field capsule.length real m = 0.1 in 0 1e6 "between the centres of its ends"
)~";

}  // namespace objdb::types
