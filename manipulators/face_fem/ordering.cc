#include "manipulators/face_fem/ordering.h"

#include <suitesparse/cholmod.h>

#include <algorithm>
#include <memory>

namespace face {
namespace {

/// a cholmod session that ends with its scope
struct Cholmod {
  cholmod_common common;
  Cholmod() {
    cholmod_start(&common);
    common.print = 0;
  }
  ~Cholmod() { cholmod_finish(&common); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;
};

void copy_supernodes(const cholmod_factor& L, Symbolic& s) {
  const auto ints = [](const void* data, std::size_t count) {
    const int* first = static_cast<const int*>(data);
    return std::vector<int>(first, first + count);
  };
  s.first = ints(L.super, L.nsuper + 1);
  s.row_start = ints(L.pi, L.nsuper + 1);
  s.row = ints(L.s, L.ssize);
  std::vector<int> supernode_of(L.n);
  for (int k = 0; k < int(L.nsuper); ++k)
    std::fill(supernode_of.begin() + s.first[k], supernode_of.begin() + s.first[k + 1], k);
  s.parent.resize(L.nsuper);
  s.panel_start.assign(L.nsuper + 1, 0);
  for (int k = 0; k < int(L.nsuper); ++k) {
    const int rows = s.rows(k), columns = s.columns(k);
    s.parent[k] = rows > columns ? supernode_of[s.rows_of(k)[columns]] : -1;
    s.panel_start[k + 1] = s.panel_start[k] + std::size_t(9) * rows * columns;
    const double below = 3.0 * (rows - columns), wide = 3.0 * columns;
    s.nonzeros += wide * (wide + 1) / 2 + below * wide;
    s.flops += wide * wide * wide / 3 + wide * wide * below + wide * below * below;
  }
}

}  // namespace

Result<Symbolic> analyse(const Stiffness& K, const std::vector<bool>& free, Order order) {
  Symbolic symbolic;
  std::vector<int> compact(K.nodes, -1), kept;
  for (int n = 0; n < K.nodes; ++n)
    if (free[n]) {
      compact[n] = int(kept.size());
      kept.push_back(n);
    }
  symbolic.place.assign(K.nodes, -1);
  const int count = int(kept.size());
  if (count == 0) {
    symbolic.first = symbolic.row_start = {0};
    symbolic.panel_start = {0};
    return symbolic;
  }

  Cholmod session;
  cholmod_common& common = session.common;
  common.nmethods = 1;
  common.method[0].ordering = order == Order::metis ? CHOLMOD_METIS : CHOLMOD_AMD;
  common.postorder = 1;
  common.supernodal = CHOLMOD_SUPERNODAL;
  std::vector<int> start(count + 1, 0), row;
  row.reserve(K.row.size());
  for (int k = 0; k < count; ++k) {
    const int c = kept[k];
    for (int i = K.start[c]; i < K.start[c + 1]; ++i)
      if (free[K.row[i]]) row.push_back(compact[K.row[i]]);
    start[k + 1] = int(row.size());
  }
  cholmod_sparse graph{};
  graph.nrow = graph.ncol = count;
  graph.nzmax = row.size();
  graph.p = start.data();
  graph.i = row.data();
  graph.stype = -1;
  graph.itype = CHOLMOD_INT;
  graph.xtype = CHOLMOD_PATTERN;
  graph.sorted = graph.packed = 1;
  cholmod_factor* L = cholmod_analyze(&graph, &common);
  if (L == nullptr || common.status < CHOLMOD_OK) {
    cholmod_free_factor(&L, &common);
    return Error{Fault::limit, "not enough memory to order " + std::to_string(count) + " nodes"};
  }
  const int* order_of = static_cast<const int*>(L->Perm);
  symbolic.node.resize(count);
  for (int k = 0; k < count; ++k) {
    symbolic.node[k] = kept[order_of[k]];
    symbolic.place[symbolic.node[k]] = k;
  }
  copy_supernodes(*L, symbolic);
  cholmod_free_factor(&L, &common);
  return symbolic;
}

}  // namespace face
