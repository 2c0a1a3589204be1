#include "manipulators/face_fem/error.h"

#include <array>

namespace face {

std::string_view name_of(Fault fault) {
  static constexpr std::array<std::string_view, 19> names = {
      "io",       "syntax", "truncated",   "unknown",   "not_finite", "material",     "element",       "numbering",
      "inverted", "mesh",   "unsupported", "zero_mode", "indefinite", "conditioning", "missed_sphere", "muscle",
      "load",     "limit",  "landmark"};
  return names[static_cast<std::size_t>(fault)];
}

}  // namespace face
