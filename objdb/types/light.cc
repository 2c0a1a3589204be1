#include <string_view>

namespace objdb::types {

extern const std::string_view light;
const std::string_view light = R"~(
type light extends node "a lamp; a sun shines along its +Z"
field light.kind word of sun point ambient "parallel from afar, from its place, from everywhere"
field light.color vec3 = 1 1 1 in 0 1 "red green blue, sRGB"
field light.intensity real = 1 in 0 1e4 "1 lights white paper fully"
field light.shadows bool = true "whether things throw shadows in it"
)~";

}  // namespace objdb::types
