#include <algorithm>

#include "manipulators/face_fem/blas.h"
#include "manipulators/face_fem/numeric.h"

// Multifrontal Cholesky (Duff and Reid 1983; Liu 1992). Each supernode gathers its columns of A and what its children
// left over in a dense front, eliminates its own columns, and leaves an update matrix for its parent. Supernodes are
// in postorder, so the updates that wait form a stack; children and parents take turns between two stacks, so that a
// parent's update can be laid down while its children's are still read.

namespace face {
namespace {

/// lower triangle of an update matrix of `size` rows (degrees of freedom), column-major, leading dimension size
struct Update {
  double* values;
  int size;
};

class Stacks {
 public:
  explicit Stacks(const Symbolic& symbolic) : depth_(symbolic.supernodes()) {
    for (int s = symbolic.supernodes() - 1; s >= 0; --s)
      depth_[s] = symbolic.parent[s] < 0 ? 0 : 1 - depth_[symbolic.parent[s]];
    // replay the pushes and pops for the greatest heights
    std::size_t height[2] = {0, 0}, greatest[2] = {0, 0};
    std::vector<std::size_t> children(symbolic.supernodes(), 0);
    for (int s = 0; s < symbolic.supernodes(); ++s) {
      const std::size_t below = 3 * std::size_t(symbolic.rows(s) - symbolic.columns(s)), size = below * below;
      const int mine = depth_[s];
      height[mine] += size;
      greatest[mine] = std::max(greatest[mine], height[mine]);
      height[1 - mine] -= children[s];
      if (symbolic.parent[s] >= 0) children[symbolic.parent[s]] += size;
    }
    for (int k = 0; k < 2; ++k) memory_[k].resize(greatest[k] + 1);
  }

  double* push(int s, std::size_t size) {
    double* place = memory_[depth_[s]].data() + height_[depth_[s]];
    height_[depth_[s]] += size;
    return place;
  }
  void pop_children_of(int s, std::size_t size) { height_[1 - depth_[s]] -= size; }

 private:
  std::vector<int> depth_;
  HugeArray<double> memory_[2];
  std::size_t height_[2] = {0, 0};
};

/// adds column j of the lower triangle of a child to a column of the parent, where the child's row block i goes to
/// row block to[i]
void add_column(const double* from, const int* to, int first_block, int blocks, int skip, double* column) {
  // the diagonal block starts inside itself
  for (int i = skip; i < 3; ++i) column[3 * to[first_block] + i] += from[3 * first_block + i];
  for (int b = first_block + 1; b < blocks;) {
    // runs of neighbouring rows are added in one go
    int end = b + 1;
    while (end < blocks && to[end] == to[end - 1] + 1) ++end;
    const double* source = from + 3 * b;
    double* target = column + 3 * to[b];
    const int length = 3 * (end - b);
    for (int k = 0; k < length; ++k) target[k] += source[k];
    b = end;
  }
}

class Fronts {
 public:
  Fronts(const Ordered& A, const Symbolic& symbolic)
      : A_(A),
        symbolic_(symbolic),
        stacks_(symbolic),
        updates_(symbolic.supernodes()),
        children_(symbolic.supernodes()),
        local_(symbolic.free_nodes(), 0) {
    for (int s = 0; s < symbolic.supernodes(); ++s)
      if (symbolic.parent[s] >= 0) children_[symbolic.parent[s]].push_back(s);
  }

  Result<Panels<double>> run() {
    Panels<double> L(symbolic_.panel_start.back());
    for (int s = 0; s < symbolic_.supernodes(); ++s) {
      const int pivot = eliminate(s, L.data() + symbolic_.panel_start[s]);
      if (pivot >= 0) return bad_pivot(symbolic_, pivot);
    }
    return L;
  }

 private:
  int eliminate(int s, double* panel) {
    const int rows = 3 * symbolic_.rows(s), columns = 3 * symbolic_.columns(s), below = rows - columns;
    const int* list = symbolic_.rows_of(s);
    for (int k = 0; k < symbolic_.rows(s); ++k) local_[list[k]] = k;
    // zeroed here and not all at once, so that the panel is in cache when it is filled
    std::fill(panel, panel + std::size_t(rows) * columns, 0.0);
    gather_matrix(s, panel, rows);
    for (int child : children_[s]) gather_children(child, s, panel, rows, nullptr);

    int info = 0;
    dpotrf_("L", &columns, panel, &rows, &info);
    if (info > 0) return 3 * symbolic_.first[s] + info - 1;
    if (below > 0) {
      const double minus = -1, none = 0;
      divide_below(panel, rows, columns);
      updates_[s] = {stacks_.push(s, std::size_t(below) * below), below};
      dsyrk_("L", "N", &below, &columns, &minus, panel + columns, &rows, &none, updates_[s].values, &below);
    }
    std::size_t popped = 0;
    for (int child : children_[s]) {
      if (below > 0) gather_children(child, s, nullptr, rows, updates_[s].values);
      popped += std::size_t(updates_[child].size) * updates_[child].size;
    }
    stacks_.pop_children_of(s, popped);
    return -1;
  }

  /// rows below the diagonal block times the inverse of its transpose, a strip of columns at a time: OpenBLAS
  /// multiplies matrices twice as fast as it solves triangles
  static void divide_below(double* panel, int rows, int columns) {
    constexpr int strip = 32;
    const double one = 1, minus = -1;
    const int below = rows - columns;
    for (int c = 0; c < columns; c += strip) {
      const int wide = std::min(strip, columns - c);
      double* mine = panel + std::size_t(c) * rows + columns;
      if (c > 0)
        dgemm_("N", "T", &below, &wide, &c, &minus, panel + columns, &rows, panel + c, &rows, &one, mine, &rows);
      dtrsm_("R", "L", "T", "N", &below, &wide, &one, panel + std::size_t(c) * rows + c, &rows, mine, &rows);
    }
  }

  void gather_matrix(int s, double* panel, int rows) const {
    for (int c = symbolic_.first[s]; c < symbolic_.first[s + 1]; ++c) {
      double* column = panel + 3 * std::size_t(c - symbolic_.first[s]) * rows;
      for (int k = A_.start[c]; k < A_.start[c + 1]; ++k) {
        const double* block = A_.block.data() + 9 * std::size_t(k);
        double* to = column + 3 * local_[A_.row[k]];
        for (int j = 0; j < 3; ++j)
          for (int i = 0; i < 3; ++i) to[std::size_t(j) * rows + i] += block[3 * i + j];
      }
    }
  }

  /// the part of a child's update that falls in the panel of s (when given) or in the update of s (when given)
  void gather_children(int child, int s, double* panel, int rows, double* update) {
    const int blocks = updates_[child].size / 3, own = symbolic_.columns(s), below = rows - 3 * own;
    const int* list = symbolic_.rows_of(child) + symbolic_.columns(child);
    to_.resize(blocks);
    for (int b = 0; b < blocks; ++b) to_[b] = local_[list[b]];
    const int split = int(std::lower_bound(to_.begin(), to_.end(), own) - to_.begin());
    if (update != nullptr)
      for (int& place : to_) place -= own;
    const int first = panel != nullptr ? 0 : split, last = panel != nullptr ? split : blocks;
    const int leading = panel != nullptr ? rows : below;
    double* base = panel != nullptr ? panel : update;
    for (int b = first; b < last; ++b)
      for (int j = 0; j < 3; ++j)
        add_column(updates_[child].values + std::size_t(3 * b + j) * updates_[child].size, to_.data(), b, blocks, j,
                   base + std::size_t(3 * to_[b] + j) * leading);
  }

  const Ordered& A_;
  const Symbolic& symbolic_;
  Stacks stacks_;
  std::vector<Update> updates_;
  std::vector<std::vector<int>> children_;
  std::vector<int> local_;  // place -> row block of the current front
  std::vector<int> to_;
};

}  // namespace

Result<Panels<double>> eliminate_fronts(const Ordered& A, const Symbolic& symbolic) {
  return Fronts(A, symbolic).run();
}

}  // namespace face
