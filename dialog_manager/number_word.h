#pragma once

#include "dialog_manager/command.h"
#include "objdb/unit.h"

namespace manager {

/// Word `index` of a call as a count of at least 1; `missing` when the call has no such word.
objdb::Result<std::uint64_t> count_word(const Call& call, std::size_t index, std::uint64_t missing);
/// Word `index` of a call as a number in SI of the unit given: "s", "Hz", "".
objdb::Result<double> real_word(const Call& call, std::size_t index, std::string_view unit);

}  // namespace manager
