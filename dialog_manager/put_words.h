#pragma once

#include <cstdint>

#include "objdb/text.h"

namespace manager {

/// The words of `put PATH.FIELD slot=K seq=N`. Error syntax.
objdb::Status parse_put(objdb::Words words, std::uint64_t& slot, std::uint64_t& sequence);

}  // namespace manager
