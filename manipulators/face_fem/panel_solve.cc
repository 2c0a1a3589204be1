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

/// 64 bytes of numbers at any address; the same partial sums on every processor
template <class Real>
struct Wide;
template <>
struct Wide<double> {
  typedef double type __attribute__((vector_size(64), aligned(8), may_alias));
};
template <>
struct Wide<float> {
  typedef float type __attribute__((vector_size(64), aligned(4), may_alias));
};

/// w[k] -= sum over the strip of L(k, c) x[c] for rows [0, count); columns are `leading` apart
template <class Real>
INLINE void subtract_strip(const Real* __restrict L, std::size_t leading, const Real* x, int count,
                           Real* __restrict w) {
  using V = typename Wide<Real>::type;
  constexpr int width = 64 / sizeof(Real);
  const Real *L0 = L, *L1 = L + leading, *L2 = L1 + leading, *L3 = L2 + leading, *L4 = L3 + leading, *L5 = L4 + leading;
  const Real x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3], x4 = x[4], x5 = x[5];
  const auto load = [](const Real* from) -> const V& { return *reinterpret_cast<const V*>(from); };
  int k = 0;
  for (; k + width <= count; k += width)
    *reinterpret_cast<V*>(w + k) -= (load(L0 + k) * x0 + load(L1 + k) * x1) + (load(L2 + k) * x2 + load(L3 + k) * x3) +
                                    (load(L4 + k) * x4 + load(L5 + k) * x5);
  for (; k < count; ++k) w[k] -= (L0[k] * x0 + L1[k] * x1) + (L2[k] * x2 + L3[k] * x3) + (L4[k] * x4 + L5[k] * x5);
}

/// sums[c] = sum over rows of L(k, c) w[k], in a fixed number of partial sums
template <class Real>
INLINE void dot_strip(const Real* __restrict L, std::size_t leading, int count, const Real* __restrict w, Real* sums) {
  using V = typename Wide<Real>::type;
  constexpr int width = 64 / sizeof(Real);
  V partial[strip] = {};
  int k = 0;
  for (; k + width <= count; k += width) {
    const V here = *reinterpret_cast<const V*>(w + k);
    for (int c = 0; c < strip; ++c) partial[c] += *reinterpret_cast<const V*>(L + c * leading + k) * here;
  }
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
  // X^T is what BLAS sees: `count` rows, one column a degree of freedom
  HugeArray<double> work(widest(s) * count);
  const double one = 1, minus = -1, none = 0;
  const std::size_t block = 3 * std::size_t(count);
  for (int k = 0; k < s.supernodes(); ++k) {
    const int rows = 3 * s.rows(k), own = 3 * s.columns(k), below = rows - own;
    const double* panel = L.data() + s.panel_start[k];
    double* mine = x + block * s.first[k];
    dtrsm_("R", "L", "T", "N", &count, &own, &one, panel, &rows, mine, &count);
    if (below == 0) continue;
    dgemm_("N", "T", &count, &below, &own, &minus, mine, &count, panel + own, &rows, &none, work.data(), &count);
    const int* list = s.rows_of(k) + s.columns(k);
    for (int b = 0; b < below / 3; ++b) {
      double* to = x + block * list[b];
      const double* from = work.data() + block * b;
      for (std::size_t i = 0; i < block; ++i) to[i] += from[i];
    }
  }
  for (int k = s.supernodes() - 1; k >= 0; --k) {
    const int rows = 3 * s.rows(k), own = 3 * s.columns(k), below = rows - own;
    const double* panel = L.data() + s.panel_start[k];
    double* mine = x + block * s.first[k];
    if (below > 0) {
      const int* list = s.rows_of(k) + s.columns(k);
      for (int b = 0; b < below / 3; ++b)
        std::copy(x + block * list[b], x + block * (list[b] + 1), work.data() + block * b);
      dgemm_("N", "N", &count, &own, &below, &minus, work.data(), &count, panel + own, &rows, &one, mine, &count);
    }
    dtrsm_("R", "L", "N", "N", &count, &own, &one, panel, &rows, mine, &count);
  }
}

}  // namespace face
