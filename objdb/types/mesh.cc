#include <string_view>

namespace objdb::types {

extern const std::string_view mesh;
const std::string_view mesh = R"~(
type mesh extends shape "a surface from a file"
field mesh.file text "OBJ, PLY, STL, Collada or glTF; metres"
)~";

}  // namespace objdb::types
