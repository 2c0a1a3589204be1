#include <suitesparse/cholmod.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "manipulators/face_fem/numeric.h"

namespace face {
namespace {

/// the ordered blocks as CHOLMOD's lower triangle of degrees of freedom
cholmod_sparse* to_sparse(const Ordered& A, int count, cholmod_common* common) {
  cholmod_sparse* sparse =
      cholmod_allocate_sparse(3 * count, 3 * count, 9 * A.row.size(), 0, 1, -1, CHOLMOD_REAL, common);
  if (sparse == nullptr) return nullptr;
  int* start = static_cast<int*>(sparse->p);
  int* row = static_cast<int*>(sparse->i);
  double* value = static_cast<double*>(sparse->x);
  int at = 0;
  for (int c = 0; c < count; ++c)
    for (int j = 0; j < 3; ++j) {
      start[3 * c + j] = at;
      for (int k = A.start[c]; k < A.start[c + 1]; ++k)
        for (int i = A.row[k] == c ? j : 0; i < 3; ++i, ++at) {
          row[at] = 3 * A.row[k] + i;
          value[at] = A.block[9 * std::size_t(k) + 3 * i + j];
        }
    }
  start[3 * count] = at;
  return sparse;
}

/// the analysis by nodes, three times as fine, in CHOLMOD's own form
cholmod_factor* to_factor(const Symbolic& s, cholmod_common* common) {
  const int n = 3 * s.free_nodes(), supers = s.supernodes();
  cholmod_factor* L = cholmod_allocate_factor(n, common);
  if (L == nullptr) return nullptr;
  L->is_super = L->is_ll = 1;
  L->ordering = CHOLMOD_NATURAL;
  L->xtype = CHOLMOD_PATTERN;
  L->nsuper = supers;
  L->ssize = 3 * s.row.size();
  L->xsize = s.panel_start[supers];
  const auto ints = [&](std::size_t count) { return static_cast<int*>(cholmod_malloc(count, sizeof(int), common)); };
  int *super = ints(supers + 1), *pi = ints(supers + 1), *px = ints(supers + 1), *row = ints(L->ssize);
  L->super = super;
  L->pi = pi;
  L->px = px;
  L->s = row;
  if (common->status < CHOLMOD_OK) return L;
  std::size_t largest_update = 1, most_below = 1;
  int* counts = static_cast<int*>(L->ColCount);
  for (int k = 0; k <= supers; ++k) {
    super[k] = 3 * s.first[k];
    pi[k] = 3 * s.row_start[k];
    px[k] = static_cast<int>(s.panel_start[k]);
    if (k == supers) break;
    const int columns = 3 * s.columns(k), rows = 3 * s.rows(k);
    for (int c = 0; c < columns; ++c) counts[super[k] + c] = rows - c;
    // rows below that fall in one ancestor are updated together: no more than all of them by all of them
    const std::size_t below = rows - columns;
    most_below = std::max(most_below, below);
    const int* list = s.rows_of(k);
    for (int first = s.columns(k), owner = s.parent[k]; first < s.rows(k);) {
      int last = first;
      while (last < s.rows(k) && list[last] < s.first[owner + 1]) ++last;
      largest_update = std::max(largest_update, std::size_t(9) * (last - first) * (s.rows(k) - first));
      if (last < s.rows(k))
        while (list[last] >= s.first[owner + 1]) owner = s.parent[owner];
      first = last;
    }
  }
  L->maxcsize = largest_update;
  L->maxesize = most_below;
  for (std::size_t k = 0; k < s.row.size(); ++k)
    for (int i = 0; i < 3; ++i) row[3 * k + i] = 3 * s.row[k] + i;
  return L;
}

}  // namespace

Result<Panels<double>> eliminate_cholmod(const Ordered& A, const Symbolic& symbolic) {
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.supernodal = CHOLMOD_SUPERNODAL;
  cholmod_sparse* sparse = to_sparse(A, symbolic.free_nodes(), &common);
  cholmod_factor* L = sparse == nullptr ? nullptr : to_factor(symbolic, &common);
  const bool started = L != nullptr && common.status == CHOLMOD_OK;
  if (started) cholmod_factorize(sparse, L, &common);
  // the status is read at once: the next call would reset it
  const int status = started ? common.status : CHOLMOD_OUT_OF_MEMORY;
  Result<Panels<double>> result = Error{Fault::limit, "not enough memory to factor"};
  if (status == CHOLMOD_NOT_POSDEF) {
    const int pivot = static_cast<int>(L->minor);
    result = bad_pivot(symbolic, pivot);
  } else if (status == CHOLMOD_OK && L->x != nullptr) {
    const double* numbers = static_cast<const double*>(L->x);
    result = Panels<double>(numbers, numbers + symbolic.panel_start.back());
  }
  cholmod_free_factor(&L, &common);
  cholmod_free_sparse(&sparse, &common);
  cholmod_finish(&common);
  return result;
}

}  // namespace face
