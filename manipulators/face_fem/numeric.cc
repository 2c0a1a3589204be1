#include "manipulators/face_fem/numeric.h"

#include <algorithm>

namespace face {

Ordered put_in_order(const Stiffness& K, const std::vector<std::array<bool, 3>>& held, const Symbolic& symbolic) {
  Ordered A;
  const int count = symbolic.free_nodes();
  A.start.assign(count + 1, 0);
  const auto each = [&](auto&& take) {
    for (int c = 0; c < K.nodes; ++c) {
      if (symbolic.place[c] < 0) continue;
      for (int k = K.start[c]; k < K.start[c + 1]; ++k)
        if (symbolic.place[K.row[k]] >= 0) take(c, K.row[k], k);
    }
  };
  each([&](int c, int r, int) { ++A.start[std::min(symbolic.place[c], symbolic.place[r]) + 1]; });
  for (int k = 0; k < count; ++k) A.start[k + 1] += A.start[k];
  A.row.resize(A.start[count]);
  A.block.resize(9 * std::size_t(A.start[count]));
  std::vector<int> next(A.start.begin(), A.start.end() - 1);
  each([&](int c, int r, int k) {
    const bool mirrored = symbolic.place[r] < symbolic.place[c];
    const int row = mirrored ? c : r, column = mirrored ? r : c;
    const int at = next[symbolic.place[column]]++;
    A.row[at] = symbolic.place[row];
    const double* from = K.block.data() + 9 * std::size_t(k);
    double* to = A.block.data() + 9 * std::size_t(at);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const bool cut = (held[row][i] || held[column][j]) && (row != column || i != j);
        to[3 * i + j] = cut ? 0 : mirrored ? from[3 * j + i] : from[3 * i + j];
      }
  });
  return A;
}

Error bad_pivot(const Symbolic& symbolic, int pivot) {
  return {Fault::indefinite,
          std::string("the stiffness is not positive along ") + "xyz"[pivot % 3] +
              ": the part is a mechanism or its material is unstable",
          symbolic.node[pivot / 3]};
}

}  // namespace face
