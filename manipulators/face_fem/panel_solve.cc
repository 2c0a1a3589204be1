#include <algorithm>
#include <vector>

#include "manipulators/face_fem/blas.h"
#include "manipulators/face_fem/numeric.h"

// wider registers where the processor has them; no fused multiply-add, so all clones give the same bits
#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#define INLINE __attribute__((always_inline)) inline

namespace face {
namespace {

constexpr int strip = 6;  // columns of L that are read together

/// w[k] -= sum over the strip of L(k, c) x[c] for rows [0, count); columns are `leading` apart
template <class Real>
INLINE void subtract_strip(const Real* __restrict L, std::size_t leading, const Real* x, int count,
                           Real* __restrict w) {
  const Real *L0 = L, *L1 = L + leading, *L2 = L1 + leading, *L3 = L2 + leading, *L4 = L3 + leading, *L5 = L4 + leading;
  const Real x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3], x4 = x[4], x5 = x[5];
  for (int k = 0; k < count; ++k)
    w[k] -= (L0[k] * x0 + L1[k] * x1) + (L2[k] * x2 + L3[k] * x3) + (L4[k] * x4 + L5[k] * x5);
}

/// sums[c] = sum over rows of L(k, c) w[k], in a fixed number of partial sums
template <class Real>
INLINE void dot_strip(const Real* __restrict L, std::size_t leading, int count, const Real* __restrict w, Real* sums) {
  constexpr int width = 64 / sizeof(Real);
  Real partial[strip][width] = {};
  int k = 0;
  for (; k + width <= count; k += width)
    for (int c = 0; c < strip; ++c)
      for (int l = 0; l < width; ++l) partial[c][l] += L[c * leading + k + l] * w[k + l];
  for (int c = 0; c < strip; ++c) {
    Real sum = 0;
    for (int l = 0; l < width; ++l) sum += partial[c][l];
    for (int rest = k; rest < count; ++rest) sum += L[c * leading + rest] * w[rest];
    sums[c] = sum;
  }
}

/// one supernode forward: w holds its rows; on return the first `columns` are solved and the rest updated
template <class Real>
INLINE void forward_panel(const Real* L, int rows, int columns, Real* w) {
  int c = 0;
  for (; c + strip <= columns; c += strip) {
    const Real* corner = L + std::size_t(c) * rows + c;
    for (int j = 0; j < strip; ++j) {
      const Real* column = corner + std::size_t(j) * rows;
      const Real x = w[c + j] /= column[j];
      for (int i = j + 1; i < strip; ++i) w[c + i] -= column[i] * x;
    }
    subtract_strip(corner + strip, rows, w + c, rows - c - strip, w + c + strip);
  }
  for (; c < columns; ++c) {
    const Real* column = L + std::size_t(c) * rows;
    const Real x = w[c] /= column[c];
    for (int i = c + 1; i < rows; ++i) w[i] -= column[i] * x;
  }
}

template <class Real>
INLINE void backward_panel(const Real* L, int rows, int columns, Real* w) {
  int c = columns;
  for (const int whole = columns / strip * strip; c > whole;) {
    --c;
    const Real* column = L + std::size_t(c) * rows;
    Real sum = 0;
    for (int i = c + 1; i < rows; ++i) sum += column[i] * w[i];
    w[c] = (w[c] - sum) / column[c];
  }
  while (c > 0) {
    c -= strip;
    const Real* corner = L + std::size_t(c) * rows + c;
    Real sums[strip];
    dot_strip(corner + strip, rows, rows - c - strip, w + c + strip, sums);
    for (int j = strip - 1; j >= 0; --j) {
      const Real* column = corner + std::size_t(j) * rows;
      Real value = w[c + j] - sums[j];
      for (int i = j + 1; i < strip; ++i) value -= column[i] * w[c + i];
      w[c + j] = value / column[j];
    }
  }
}

template <class Real>
INLINE void forward_all(const Symbolic& s, const Real* L, Real* x, Real* w) {
  for (int k = 0; k < s.supernodes(); ++k) {
    const int blocks = s.rows(k), own = s.columns(k);
    const int* list = s.rows_of(k);
    Real* mine = x + 3 * std::size_t(s.first[k]);
    std::copy(mine, mine + 3 * own, w);
    std::fill(w + 3 * own, w + 3 * blocks, Real(0));
    forward_panel(L + s.panel_start[k], 3 * blocks, 3 * own, w);
    std::copy(w, w + 3 * own, mine);
    for (int b = own; b < blocks; ++b)
      for (int i = 0; i < 3; ++i) x[3 * std::size_t(list[b]) + i] += w[3 * b + i];
  }
}

template <class Real>
INLINE void backward_all(const Symbolic& s, const Real* L, Real* x, Real* w) {
  for (int k = s.supernodes() - 1; k >= 0; --k) {
    const int blocks = s.rows(k), own = s.columns(k);
    const int* list = s.rows_of(k);
    for (int b = 0; b < blocks; ++b)
      for (int i = 0; i < 3; ++i) w[3 * b + i] = x[3 * std::size_t(list[b]) + i];
    backward_panel(L + s.panel_start[k], 3 * blocks, 3 * own, w);
    std::copy(w, w + 3 * own, x + 3 * std::size_t(s.first[k]));
  }
}

std::size_t widest(const Symbolic& s) {
  int rows = 0;
  for (int k = 0; k < s.supernodes(); ++k) rows = std::max(rows, s.rows(k));
  return 3 * std::size_t(rows);
}

WIDEST void forward_double(const Symbolic& s, const double* L, double* x, double* w) { forward_all(s, L, x, w); }
WIDEST void backward_double(const Symbolic& s, const double* L, double* x, double* w) { backward_all(s, L, x, w); }
WIDEST void forward_float(const Symbolic& s, const float* L, float* x, float* w) { forward_all(s, L, x, w); }
WIDEST void backward_float(const Symbolic& s, const float* L, float* x, float* w) { backward_all(s, L, x, w); }

}  // namespace

void forward(const Symbolic& symbolic, const Panels<double>& L, double* x) {
  std::vector<double> work(widest(symbolic));
  forward_double(symbolic, L.data(), x, work.data());
}

void backward(const Symbolic& symbolic, const Panels<double>& L, double* x) {
  std::vector<double> work(widest(symbolic));
  backward_double(symbolic, L.data(), x, work.data());
}

void forward(const Symbolic& symbolic, const Panels<float>& L, float* x) {
  std::vector<float> work(widest(symbolic));
  forward_float(symbolic, L.data(), x, work.data());
}

void backward(const Symbolic& symbolic, const Panels<float>& L, float* x) {
  std::vector<float> work(widest(symbolic));
  backward_float(symbolic, L.data(), x, work.data());
}

void solve_many(const Symbolic& s, const Panels<double>& L, double* x, int count) {
  const std::size_t length = 3 * std::size_t(s.free_nodes());
  std::vector<double> work(widest(s) * count);
  const double one = 1, minus = -1, none = 0;
  for (int k = 0; k < s.supernodes(); ++k) {
    const int rows = 3 * s.rows(k), own = 3 * s.columns(k), below = rows - own;
    const double* panel = L.data() + s.panel_start[k];
    double* mine = x + 3 * std::size_t(s.first[k]);
    const int leading = static_cast<int>(length);
    dtrsm_("L", "L", "N", "N", &own, &count, &one, panel, &rows, mine, &leading);
    if (below == 0) continue;
    dgemm_("N", "N", &below, &count, &own, &minus, panel + own, &rows, mine, &leading, &none, work.data(), &below);
    const int* list = s.rows_of(k) + s.columns(k);
    for (int c = 0; c < count; ++c)
      for (int b = 0; b < below / 3; ++b)
        for (int i = 0; i < 3; ++i)
          x[length * c + 3 * std::size_t(list[b]) + i] += work[std::size_t(below) * c + 3 * b + i];
  }
  for (int k = s.supernodes() - 1; k >= 0; --k) {
    const int rows = 3 * s.rows(k), own = 3 * s.columns(k), below = rows - own;
    const double* panel = L.data() + s.panel_start[k];
    double* mine = x + 3 * std::size_t(s.first[k]);
    const int leading = static_cast<int>(length);
    if (below > 0) {
      const int* list = s.rows_of(k) + s.columns(k);
      for (int c = 0; c < count; ++c)
        for (int b = 0; b < below / 3; ++b)
          for (int i = 0; i < 3; ++i)
            work[std::size_t(below) * c + 3 * b + i] = x[length * c + 3 * std::size_t(list[b]) + i];
      dgemm_("T", "N", &own, &count, &below, &minus, panel + own, &rows, work.data(), &below, &one, mine, &leading);
    }
    dtrsm_("L", "L", "T", "N", &own, &count, &one, panel, &rows, mine, &leading);
  }
}

}  // namespace face
