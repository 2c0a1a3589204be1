#include "objdb/result.h"

#include <array>

namespace objdb {

std::string_view name_of(ErrorKind kind) {
  static constexpr std::array<std::string_view, 12> names = {"syntax", "unknown", "exists",  "type", "unit",  "range",
                                                             "owner",  "busy",    "timeout", "gone", "limit", "io"};
  return names[static_cast<std::size_t>(kind)];
}

}  // namespace objdb
