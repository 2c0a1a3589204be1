#include "manipulators/face_fem/column_sum.h"

#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))

namespace face {

WIDEST void add_columns(const float* const* column, const float* amount, int count, std::size_t length,
                        float* __restrict sum) {
  int c = 0;
  for (; c + 4 <= count; c += 4) {
    const float *c0 = column[c], *c1 = column[c + 1], *c2 = column[c + 2], *c3 = column[c + 3];
    const float a0 = amount[c], a1 = amount[c + 1], a2 = amount[c + 2], a3 = amount[c + 3];
    for (std::size_t k = 0; k < length; ++k) sum[k] += (a0 * c0[k] + a1 * c1[k]) + (a2 * c2[k] + a3 * c3[k]);
  }
  for (; c < count; ++c)
    for (std::size_t k = 0; k < length; ++k) sum[k] += amount[c] * column[c][k];
}

}  // namespace face
