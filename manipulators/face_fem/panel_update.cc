#include <algorithm>
#include <cmath>
#include <vector>

#include "manipulators/face_fem/numeric.h"

// wider registers where the processor has them; no fused multiply-add, so all clones give the same bits
#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))

namespace face {
namespace {

constexpr int width = 8;  // rows that are turned together

/// the rows of W that meet one panel, in groups of `width` rows: group, column of W, row
struct Rows {
  std::vector<double> values;
  int rank = 0;
  void resize(int rows, int columns) {
    rank = columns;
    values.assign(std::size_t((rows + width - 1) / width) * width * rank, 0.0);
  }
  double& at(int row, int column) { return values[(std::size_t(row / width) * rank + column) * width + row % width]; }
};

/// `width` numbers at any address
typedef double Group __attribute__((vector_size(8 * width), aligned(8), may_alias));

/// turns rows of L's column and of W by all the rotations of that column, two groups side by side because each
/// rotation waits for the one before
WIDEST void turn_rows(double* __restrict column, double* __restrict w, int groups, int rank, const double* cosine,
                      const double* sine) {
  const std::size_t stride = std::size_t(rank) * width;
  int g = 0;
  for (; g + 2 <= groups; g += 2, column += 2 * width, w += 2 * stride) {
    Group l = *reinterpret_cast<Group*>(column), m = *reinterpret_cast<Group*>(column + width);
    for (int r = 0; r < rank; ++r) {
      Group& first = *reinterpret_cast<Group*>(w + r * width);
      Group& second = *reinterpret_cast<Group*>(w + stride + r * width);
      const Group turned = cosine[r] * l + sine[r] * first, other = cosine[r] * m + sine[r] * second;
      first = cosine[r] * first - sine[r] * l;
      second = cosine[r] * second - sine[r] * m;
      l = turned;
      m = other;
    }
    *reinterpret_cast<Group*>(column) = l;
    *reinterpret_cast<Group*>(column + width) = m;
  }
  if (g == groups) return;
  Group l = *reinterpret_cast<Group*>(column);
  for (int r = 0; r < rank; ++r) {
    Group& first = *reinterpret_cast<Group*>(w + r * width);
    const Group turned = cosine[r] * l + sine[r] * first;
    first = cosine[r] * first - sine[r] * l;
    l = turned;
  }
  *reinterpret_cast<Group*>(column) = l;
}

/// the same by hyperbolic rotations in mixed form: the new L is used for the new W, which keeps the error small
WIDEST void turn_rows_away(double* __restrict column, double* __restrict w, int groups, int rank, const double* scale,
                           const double* inverse, const double* sine) {
  const std::size_t stride = std::size_t(rank) * width;
  int g = 0;
  for (; g + 2 <= groups; g += 2, column += 2 * width, w += 2 * stride) {
    Group l = *reinterpret_cast<Group*>(column), m = *reinterpret_cast<Group*>(column + width);
    for (int r = 0; r < rank; ++r) {
      Group& first = *reinterpret_cast<Group*>(w + r * width);
      Group& second = *reinterpret_cast<Group*>(w + stride + r * width);
      l = (l - sine[r] * first) * inverse[r];
      m = (m - sine[r] * second) * inverse[r];
      first = scale[r] * first - sine[r] * l;
      second = scale[r] * second - sine[r] * m;
    }
    *reinterpret_cast<Group*>(column) = l;
    *reinterpret_cast<Group*>(column + width) = m;
  }
  if (g == groups) return;
  Group l = *reinterpret_cast<Group*>(column);
  for (int r = 0; r < rank; ++r) {
    Group& first = *reinterpret_cast<Group*>(w + r * width);
    l = (l - sine[r] * first) * inverse[r];
    first = scale[r] * first - sine[r] * l;
  }
  *reinterpret_cast<Group*>(column) = l;
}

/// one panel; `buffer` holds a column padded to whole groups
int update_panel(double* panel, int rows, int columns, int sign, Rows& W, std::vector<double>& buffer) {
  std::vector<double> first(W.rank), second(W.rank), inverse(W.rank);
  for (int c = 0; c < columns; ++c) {
    double* column = panel + std::size_t(c) * rows;
    double pivot = column[c];
    for (int r = 0; r < W.rank; ++r) {
      const double w = W.at(c, r), square = pivot * pivot + sign * w * w;
      if (!(square > 0)) return c;
      const double next = std::sqrt(square);
      first[r] = sign > 0 ? pivot / next : next / pivot;
      second[r] = sign > 0 ? w / next : w / pivot;
      inverse[r] = pivot / next;
      pivot = next;
    }
    // whole groups from the one that holds the diagonal; rows above it are put back afterwards
    const int start = c / width * width, groups = (rows - start + width - 1) / width;
    std::copy(column + start, column + rows, buffer.begin());
    std::fill(buffer.begin() + (rows - start), buffer.begin() + std::size_t(groups) * width, 0.0);
    for (int k = start; k < c; ++k) buffer[k - start] = 0;
    double* w = W.values.data() + std::size_t(start / width) * W.rank * width;
    if (sign > 0)
      turn_rows(buffer.data(), w, groups, W.rank, first.data(), second.data());
    else
      turn_rows_away(buffer.data(), w, groups, W.rank, first.data(), inverse.data(), second.data());
    std::copy(buffer.begin() + (c - start), buffer.begin() + (rows - start), column + c);
    column[c] = pivot;
  }
  return -1;
}

}  // namespace

int update_panels(const Symbolic& symbolic, Panels<double>& L, const std::vector<int>& places, const Eigen::MatrixXd& W,
                  int sign) {
  const int lowest = *std::min_element(places.begin(), places.end()), rank = int(W.cols());
  int s = int(std::upper_bound(symbolic.first.begin(), symbolic.first.end(), lowest) - symbolic.first.begin()) - 1;
  Rows rows, next;
  std::vector<double> buffer;
  const auto local = [&](int super, int place) {
    const int* list = symbolic.rows_of(super);
    return int(std::lower_bound(list, list + symbolic.rows(super), place) - list);
  };
  rows.resize(3 * symbolic.rows(s), rank);
  for (std::size_t k = 0; k < places.size(); ++k)
    for (int i = 0; i < 3; ++i)
      for (int r = 0; r < rank; ++r) rows.at(3 * local(s, places[k]) + i, r) = W(3 * Eigen::Index(k) + i, r);
  for (;;) {
    const int height = 3 * symbolic.rows(s), columns = 3 * symbolic.columns(s), parent = symbolic.parent[s];
    buffer.resize(std::size_t(height) + 2 * width);
    const int bad = update_panel(L.data() + symbolic.panel_start[s], height, columns, sign, rows, buffer);
    if (bad >= 0) return 3 * symbolic.first[s] + bad;
    if (parent < 0) return -1;
    // what is left of W lies in rows that the parent has too
    next.resize(3 * symbolic.rows(parent), rank);
    for (int b = symbolic.columns(s); b < symbolic.rows(s); ++b) {
      const int to = 3 * local(parent, symbolic.rows_of(s)[b]);
      for (int i = 0; i < 3; ++i)
        for (int r = 0; r < rank; ++r) next.at(to + i, r) = rows.at(3 * b + i, r);
    }
    std::swap(rows, next);
    s = parent;
  }
}

}  // namespace face
