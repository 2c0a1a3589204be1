#pragma once

#include <string_view>

#include "objdb/result.h"

namespace manager {

/// "error KIND [COLUMN] sentence" as a program says it; io, when the kind is none.
objdb::Error parse_said_error(std::string_view text);

}  // namespace manager
