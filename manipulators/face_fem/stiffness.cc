#include "manipulators/face_fem/stiffness.h"

#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/element_batch.h"

namespace face {
namespace {

/// which hexahedra touch a node: those of node n are hexahedron[start[n] .. start[n + 1]]
struct Incidence {
  std::vector<int> start, hexahedron;
};

Incidence incidence_of(const Model& model) {
  const int count = nodes_of(model.element), nodes = static_cast<int>(model.nodes.size());
  Incidence incidence;
  incidence.start.assign(nodes + 1, 0);
  for (const Hexahedron& hexahedron : model.hexahedra)
    for (int a = 0; a < count; ++a) ++incidence.start[hexahedron.node[a] + 1];
  for (int n = 0; n < nodes; ++n) incidence.start[n + 1] += incidence.start[n];
  incidence.hexahedron.resize(incidence.start[nodes]);
  std::vector<int> next(incidence.start.begin(), incidence.start.end() - 1);
  for (std::size_t e = 0; e < model.hexahedra.size(); ++e)
    for (int a = 0; a < count; ++a) incidence.hexahedron[next[model.hexahedra[e].node[a]]++] = static_cast<int>(e);
  return incidence;
}

void make_pattern(const Model& model, Stiffness& K) {
  const int count = nodes_of(model.element);
  const Incidence incidence = incidence_of(model);
  std::vector<int> seen(K.nodes, -1);
  K.start.assign(K.nodes + 1, 0);
  K.row.reserve(K.nodes * (count == 8 ? 15 : 45));
  for (int c = 0; c < K.nodes; ++c) {
    const std::size_t first = K.row.size();
    for (int k = incidence.start[c]; k < incidence.start[c + 1]; ++k)
      for (int a = 0; a < count; ++a) {
        const int r = model.hexahedra[incidence.hexahedron[k]].node[a];
        if (r < c || seen[r] == c) continue;
        seen[r] = c;
        K.row.push_back(r);
      }
    std::sort(K.row.begin() + first, K.row.end());
    K.start[c + 1] = static_cast<int>(K.row.size());
  }
  K.block.assign(9 * K.row.size(), 0.0);
}

/// adds lane `lane` of the batch to the entries of hexahedron's nodes
void scatter(const Hexahedron& hexahedron, int count, const Batch& batch, int lane, double factor, Stiffness& K) {
  for (int a = 0; a < count; ++a)
    for (int b = 0; b <= a; ++b) {
      const auto& from = batch.K[pair_index(a, b)];
      const int na = hexahedron.node[a], nb = hexahedron.node[b];
      double* to = K.block.data() + 9 * static_cast<std::size_t>(K.entry(std::max(na, nb), std::min(na, nb)));
      // a wedge has the same node twice: both halves of the pair fall on its diagonal block
      const bool direct = na > nb || a == b || na == nb, mirrored = na < nb || (na == nb && a != b);
      if (direct)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) to[3 * i + j] += factor * from[i][j][lane];
      if (mirrored)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) to[3 * i + j] += factor * from[j][i][lane];
    }
}

void load_lane(const Model& model, int hexahedron, int lane, Batch& batch) {
  const int count = nodes_of(model.element);
  const Hexahedron& h = model.hexahedra[hexahedron];
  for (int a = 0; a < count; ++a)
    for (int i = 0; i < 3; ++i) batch.X[a][i][lane] = model.nodes[h.node[a]][i];
  const Lame lame = model.materials[h.material].lame();
  batch.lambda[lane] = lame.lambda;
  batch.mu[lane] = lame.mu;
}

}  // namespace

int Stiffness::entry(int row_node, int column) const {
  const auto first = row.begin() + start[column], last = row.begin() + start[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row_node) - row.begin());
}

Result<Stiffness> assemble(const Model& model) {
  Stiffness K;
  K.nodes = static_cast<int>(model.nodes.size());
  make_pattern(model, K);
  const int count = nodes_of(model.element), elements = static_cast<int>(model.hexahedra.size());
  Batch batch;
  for (int first = 0; first < elements; first += lanes) {
    const int used = std::min(lanes, elements - first);
    for (int lane = 0; lane < lanes; ++lane) load_lane(model, first + std::min(lane, used - 1), lane, batch);
    fill_stiffness(model.element, batch);
    for (int lane = 0; lane < used; ++lane) {
      if (!(batch.smallest[lane] > 0))
        return Error{Fault::inverted, "element " + std::to_string(model.label_of_hexahedron(first + lane)) +
                                          ": the Jacobian at an integration point must be positive, is " +
                                          std::to_string(batch.smallest[lane])};
      scatter(model.hexahedra[first + lane], count, batch, lane, 1, K);
    }
  }
  for (double entry : K.block)
    if (!std::isfinite(entry)) return Error{Fault::not_finite, "the stiffness matrix has an entry that is not finite"};
  return K;
}

void add_element(const Model& model, int hexahedron, double factor, Stiffness& K) {
  Batch batch;
  for (int lane = 0; lane < lanes; ++lane) load_lane(model, hexahedron, lane, batch);
  fill_stiffness(model.element, batch);
  scatter(model.hexahedra[hexahedron], nodes_of(model.element), batch, 0, factor, K);
}

Field multiply(const Stiffness& K, const Field& u) {
  Field f = Field::Zero(3, K.nodes);
  for (int c = 0; c < K.nodes; ++c) {
    const Eigen::Vector3d uc = u.col(c);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = K.start[c]; k < K.start[c + 1]; ++k) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(K.block.data() + 9 * std::size_t(k));
      const int r = K.row[k];
      if (r == c) {
        sum += block * uc;
      } else {
        f.col(r) += block * uc;
        sum += block.transpose() * u.col(r);
      }
    }
    f.col(c) += sum;
  }
  return f;
}

}  // namespace face
