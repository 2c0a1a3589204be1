#include "manipulators/face_fem/factor.h"

#include <cmath>
#include <sstream>
#include <string>

#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/numeric.h"

namespace face {

struct Factor::Content {
  Symbolic symbolic;
  std::vector<std::array<bool, 3>> held;
  Panels<double> L;
  mutable Panels<float> single;
  FactorCost cost;
  Elimination elimination = Elimination::fronts;
};

namespace {

constexpr double least_rcond = 1e-12;

/// a field in elimination order, held axes as zero
template <class Real>
void put_in_order(const Symbolic& s, const std::vector<std::array<bool, 3>>& held, const double* f, Real* x) {
  for (int k = 0; k < s.free_nodes(); ++k)
    for (int i = 0; i < 3; ++i) x[3 * k + i] = held[s.node[k]][i] ? Real(0) : Real(f[3 * std::size_t(s.node[k]) + i]);
}

template <class Real>
void put_back(const Symbolic& s, const Real* x, double* u) {
  for (int k = 0; k < s.free_nodes(); ++k)
    for (int i = 0; i < 3; ++i) u[3 * std::size_t(s.node[k]) + i] = x[3 * k + i];
}

std::vector<double> diagonal(const Symbolic& s, const Panels<double>& L) {
  std::vector<double> entries;
  entries.reserve(3 * std::size_t(s.free_nodes()));
  for (int k = 0; k < s.supernodes(); ++k)
    for (int c = 0; c < 3 * s.columns(k); ++c)
      entries.push_back(L[s.panel_start[k] + std::size_t(c) * (3 * s.rows(k) + 1)]);
  return entries;
}

}  // namespace

Factor::Factor(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Factor::Factor(Factor&&) noexcept = default;
Factor& Factor::operator=(Factor&&) noexcept = default;
Factor::~Factor() = default;

Result<Factor> Factor::make(const Stiffness& K, const std::vector<std::array<bool, 3>>& held,
                            const FactorOptions& options) {
  auto content = std::make_unique<Content>();
  content->held = held;
  // nodes of no element have no diagonal and stay where they are
  std::vector<bool> free(K.nodes);
  for (int n = 0; n < K.nodes; ++n) free[n] = K.start[n + 1] > K.start[n] && !(held[n][0] && held[n][1] && held[n][2]);
  const double begin = cpu_seconds();
  auto symbolic = analyse(K, free, options.order);
  if (!symbolic) return symbolic.error();
  content->symbolic = std::move(*symbolic);
  content->elimination = options.elimination;
  content->cost.order_seconds = cpu_seconds() - begin;
  content->cost.nonzeros = content->symbolic.nonzeros;
  content->cost.flops = content->symbolic.flops;
  content->cost.bytes = 8.0 * double(content->symbolic.panel_start.back());
  Factor factor(std::move(content));
  if (auto status = factor.refactor(K); !status) return status.error();
  return factor;
}

Status Factor::refactor(const Stiffness& K) {
  const double begin = cpu_seconds();
  const Ordered A = put_in_order(K, content_->held, content_->symbolic);
  auto L = content_->elimination == Elimination::fronts ? eliminate_fronts(A, content_->symbolic)
                                                        : eliminate_cholmod(A, content_->symbolic);
  if (!L) return L.error();
  content_->L = std::move(*L);
  content_->single.clear();
  content_->cost.factor_seconds = cpu_seconds() - begin;
  const double condition = rcond();
  if (condition >= least_rcond) return success();
  // the degree of freedom with the smallest pivot shows where the mechanism is
  const std::vector<double> d = diagonal(symbolic(), content_->L);
  int weakest = 0;
  for (int k = 0; k < int(d.size()); ++k)
    if (!(d[k] >= d[weakest])) weakest = k;
  std::ostringstream text;
  text << "the reciprocal condition must be at least " << least_rcond << ", is " << condition
       << ": something can move without resistance";
  return Error{Fault::conditioning, text.str(), symbolic().node[weakest / 3]};
}

Field Factor::solve(const Field& f) const {
  const Symbolic& s = content_->symbolic;
  std::vector<double> x(3 * std::size_t(s.free_nodes()));
  put_in_order(s, content_->held, f.data(), x.data());
  forward(s, content_->L, x.data());
  backward(s, content_->L, x.data());
  Field u = Field::Zero(3, f.cols());
  put_back(s, x.data(), u.data());
  return u;
}

Field Factor::solve_single(const Field& f) const {
  const Symbolic& s = content_->symbolic;
  if (content_->single.empty()) content_->single.assign(content_->L.begin(), content_->L.end());
  std::vector<float> x(3 * std::size_t(s.free_nodes()));
  put_in_order(s, content_->held, f.data(), x.data());
  forward(s, content_->single, x.data());
  backward(s, content_->single, x.data());
  Field u = Field::Zero(3, f.cols());
  put_back(s, x.data(), u.data());
  return u;
}

void Factor::solve_all(Eigen::Ref<Eigen::MatrixXd> columns) const {
  const Symbolic& s = content_->symbolic;
  const int count = static_cast<int>(columns.cols());
  HugeArray<double> x(3 * std::size_t(s.free_nodes()) * count);
  const auto& held = content_->held;
  for (int k = 0; k < s.free_nodes(); ++k)
    for (int i = 0; i < 3; ++i) {
      double* row = x.data() + (3 * std::size_t(k) + i) * count;
      const Eigen::Index from = 3 * Eigen::Index(s.node[k]) + i;
      for (int c = 0; c < count; ++c) row[c] = held[s.node[k]][i] ? 0 : columns(from, c);
    }
  solve_many(s, content_->L, x.data(), count);
  columns.setZero();
  for (int k = 0; k < s.free_nodes(); ++k)
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < count; ++c)
        columns(3 * Eigen::Index(s.node[k]) + i, c) = x[(3 * std::size_t(k) + i) * count + c];
}

Status Factor::update(const std::vector<int>& nodes, const Eigen::MatrixXd& W, int sign) {
  const Symbolic& s = content_->symbolic;
  std::vector<int> places;
  std::vector<int> rows;
  for (int k = 0; k < int(nodes.size()); ++k)
    if (s.place[nodes[k]] >= 0) {
      places.push_back(s.place[nodes[k]]);
      rows.push_back(k);
    }
  content_->single.clear();
  if (places.empty()) return success();
  Eigen::MatrixXd kept(3 * Eigen::Index(rows.size()), W.cols());
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (int i = 0; i < 3; ++i) {
      const Eigen::Index row = 3 * Eigen::Index(k) + i;
      kept.row(row) = W.row(3 * rows[k] + i);
      // a held axis keeps its own diagonal entry
      if (content_->held[nodes[rows[k]]][i]) kept.row(row).setZero();
    }
  const int bad = update_panels(s, content_->L, places, kept, sign);
  if (bad >= 0) return bad_pivot(s, bad);
  return success();
}

double Factor::rcond() const {
  const std::vector<double> d = diagonal(content_->symbolic, content_->L);
  if (d.empty()) return 1;
  double low = HUGE_VAL, high = 0;
  for (double entry : d) {
    // a NaN must not hide between the others
    if (!std::isfinite(entry)) return 0;
    low = std::min(low, entry);
    high = std::max(high, entry);
  }
  return low * low / (high * high);
}

const FactorCost& Factor::cost() const { return content_->cost; }
const Symbolic& Factor::symbolic() const { return content_->symbolic; }

}  // namespace face
