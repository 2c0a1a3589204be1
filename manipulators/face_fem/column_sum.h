#pragma once

#include <cstddef>

namespace face {

/// sum += the columns times their amounts, `length` numbers each, a few columns at a time so that the sum is written
/// seldom. In vector registers as wide as the processor has; the same bits in each.
void add_columns(const float* const* column, const float* amount, int count, std::size_t length, float* sum);

}  // namespace face
