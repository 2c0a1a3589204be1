#include "manipulators/face_fem/element_batch.h"

#include <cmath>

#include "manipulators/face_fem/shape.h"

// wider registers where the processor has them; no fused multiply-add, so all clones give the same bits
#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#define INLINE __attribute__((always_inline)) inline

namespace face {
namespace {

constexpr int bubbles = 3;

INLINE void zero(Lane& lane) { lane = Lane{}; }

struct Frame {
  Lane J[3][3];  // J[i][j] = dx_j / dxi_i
  Lane inverse[3][3];
  Lane det;
};

INLINE void invert(Frame& f) {
  auto& J = f.J;
  Lane cofactor[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      cofactor[i][j] = J[i1][j1] * J[i2][j2] - J[i1][j2] * J[i2][j1];
    }
  f.det = J[0][0] * cofactor[0][0] + J[0][1] * cofactor[0][1] + J[0][2] * cofactor[0][2];
  const Lane scale = 1.0 / f.det;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) f.inverse[j][i] = cofactor[i][j] * scale;
}

template <int Nodes>
INLINE void frame_at(const Batch& batch, const double (*dN)[3], Frame& f) {
  for (auto& row : f.J)
    for (Lane& entry : row) zero(entry);
  for (int a = 0; a < Nodes; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) f.J[i][j] += dN[a][i] * batch.X[a][j];
  invert(f);
}

// sums over the points of weight g_a g_b^T into K, and of weight g_a into `total`; g of the bubbles follow those of the
// nodes
template <int Nodes, int Extra>
INLINE void moments(const Rule& rule, Batch& batch, Lane (*total)[3]) {
  for (int p = 0; p < pairs_of(Nodes + Extra); ++p)
    for (auto& row : batch.K[p])
      for (Lane& entry : row) zero(entry);
  for (int a = 0; a < Nodes; ++a)
    for (int i = 0; i < 3; ++i) zero(total[a][i]);
  zero(batch.volume);
  zero(batch.smallest);
  batch.smallest += HUGE_VAL;

  Frame centre;
  if (Extra > 0) {
    double dN[20][3];
    shape_gradient(Nodes, Eigen::Vector3d::Zero(), dN);
    frame_at<Nodes>(batch, dN, centre);
  }
  for (int q = 0; q < rule.points; ++q) {
    const auto& dN = rule.dN[q];
    Frame f;
    frame_at<Nodes>(batch, dN, f);
    batch.smallest = f.det < batch.smallest ? f.det : batch.smallest;
    const Lane weight = rule.weight[q] * f.det;
    batch.volume += weight;
    Lane g[Nodes + Extra][3];
    for (int a = 0; a < Nodes; ++a)
      for (int j = 0; j < 3; ++j) {
        g[a][j] = f.inverse[j][0] * dN[a][0] + f.inverse[j][1] * dN[a][1] + f.inverse[j][2] * dN[a][2];
        total[a][j] += weight * g[a][j];
      }
    // Taylor's correction: the bubbles see the Jacobian of the centre, scaled, so that their strain has no mean
    for (int k = 0; k < Extra; ++k)
      for (int j = 0; j < 3; ++j) g[Nodes + k][j] = centre.det / f.det * centre.inverse[j][k] * (-2 * rule.xi[q][k]);
    for (int a = 0; a < Nodes + Extra; ++a) {
      const Lane left[3] = {weight * g[a][0], weight * g[a][1], weight * g[a][2]};
      for (int b = 0; b <= a; ++b) {
        auto& M = batch.K[pair_index(a, b)];
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) M[i][j] += left[i] * g[b][j];
      }
    }
  }
}

// turns sums of g_a g_b^T into stiffness: lambda M + mu (M^T + tr M)
INLINE void elastic(Batch& batch, int pairs, const Lane& lambda) {
  for (int p = 0; p < pairs; ++p) {
    auto& M = batch.K[p];
    const Lane trace = batch.mu * (M[0][0] + M[1][1] + M[2][2]);
    for (int i = 0; i < 3; ++i) M[i][i] = lambda * M[i][i] + batch.mu * M[i][i] + trace;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j) {
        const Lane below = M[i][j], above = M[j][i];
        M[i][j] = lambda * below + batch.mu * above;
        M[j][i] = lambda * above + batch.mu * below;
      }
  }
}

// eliminates the bubbles one degree of freedom after the other; they are the last rows of the packed triangle
INLINE void condense(Batch& batch, int nodes) {
  for (int last = 3 * (nodes + bubbles) - 1; last >= 3 * nodes; --last) {
    const int a = last / 3, i = last % 3;
    const Lane pivot = 1.0 / batch.K[pair_index(a, a)][i][i];
    for (int row = 0; row < last; ++row) {
      const Lane left = batch.K[pair_index(a, row / 3)][i][row % 3] * pivot;
      // within the diagonal block both triangles are kept
      const int end = 3 * (row / 3) + 3;
      for (int column = 0; column < end && column < last; ++column)
        batch.K[pair_index(row / 3, column / 3)][row % 3][column % 3] -=
            left * batch.K[pair_index(a, column / 3)][i][column % 3];
    }
  }
}

WIDEST void fill_hex8(const Rule& rule, Batch& batch) {
  Lane total[8][3];
  moments<8, 0>(rule, batch, total);
  elastic(batch, pairs_of(8), batch.lambda);
}

WIDEST void fill_bbar(const Rule& rule, Batch& batch) {
  Lane total[8][3];
  moments<8, 0>(rule, batch, total);
  const Lane deviatoric = batch.mu * (-2.0 / 3), bulk = (batch.lambda - deviatoric) / batch.volume;
  elastic(batch, pairs_of(8), deviatoric);
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b <= a; ++b)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) batch.K[pair_index(a, b)][i][j] += bulk * total[a][i] * total[b][j];
}

WIDEST void fill_wt(const Rule& rule, Batch& batch) {
  Lane total[8][3];
  moments<8, bubbles>(rule, batch, total);
  elastic(batch, pairs_of(8 + bubbles), batch.lambda);
  condense(batch, 8);
}

WIDEST void fill_hex20(const Rule& rule, Batch& batch) {
  Lane total[20][3];
  moments<20, 0>(rule, batch, total);
  elastic(batch, pairs_of(20), batch.lambda);
}

}  // namespace

void fill_stiffness(Element element, Batch& batch) {
  const Rule& rule = rule_of(element);
  switch (element) {
    case Element::hex8: return fill_hex8(rule, batch);
    case Element::bbar: return fill_bbar(rule, batch);
    case Element::wt: return fill_wt(rule, batch);
    case Element::hex20:
    case Element::hex20r: return fill_hex20(rule, batch);
  }
}

}  // namespace face
