#include "manipulators/face_fem/lips.h"

#include <algorithm>
#include <cmath>

namespace face {

LipContact::LipContact(const Model& model, const Slit& slit, const std::vector<bool>& held, Basis& basis) {
  for (const SlitPair& pair : slit.pairs) {
    if (pair.upper < 0 || pair.lower < 0) continue;
    if (held[std::size_t(pair.upper)] && held[std::size_t(pair.lower)]) continue;
    const Eigen::Vector3d between = model.nodes[std::size_t(pair.upper)] - model.nodes[std::size_t(pair.lower)];
    // a gap that is negative at rest is the mesh's own: it is no contact
    pairs_.push_back({pair.upper, pair.lower, pair.normal, std::max(pair.normal.dot(between), 0.0)});
  }
  by_column_.resize(pairs(), 0);
  for (int c = 0; c < basis.columns(); ++c) read(basis, c);
  std::vector<Field> loads;
  for (int i = 0; i < pairs(); ++i) {
    loads.push_back(Field::Zero(3, Eigen::Index(model.nodes.size())));
    add_load(i, 1, loads.back());
  }
  first_ = basis.add(loads);
  compliance_.resize(pairs(), pairs());
  for (int j = 0; j < pairs(); ++j)
    for (int i = 0; i < pairs(); ++i) compliance_(i, j) = gap_of(pairs_[std::size_t(i)], basis.column(first_ + j));
}

double LipContact::gap_of(const Pair& pair, const Field& u) const {
  return pair.normal.dot(u.col(pair.upper) - u.col(pair.lower));
}

void LipContact::add_load(int i, double force, Field& load) const {
  const Pair& pair = pairs_[std::size_t(i)];
  load.col(pair.upper) += force * pair.normal;
  load.col(pair.lower) -= force * pair.normal;
}

void LipContact::read(const Basis& basis, int column) {
  // the columns between, if any, are those of the pairs themselves
  if (by_column_.cols() <= column) {
    const Eigen::Index known = by_column_.cols();
    by_column_.conservativeResize(pairs(), column + 1);
    by_column_.rightCols(column + 1 - known).setZero();
  }
  for (int i = 0; i < pairs(); ++i) by_column_(i, column) = gap_of(pairs_[std::size_t(i)], basis.column(column));
}

LipContact::Answer LipContact::solve(const double* amounts, double tone) const {
  Answer answer;
  const int n = pairs();
  Eigen::VectorXd gap(n);
  for (int i = 0; i < n; ++i) gap[i] = pairs_[std::size_t(i)].gap;
  for (int c = 0; c < by_column_.cols(); ++c)
    if (amounts[c] != 0) gap += amounts[c] * by_column_.col(c);
  answer.force = Eigen::VectorXd::Zero(n);
  // where nothing holds and nothing touches there is nothing to solve
  if (n > 0 && (tone > 0 || gap.minCoeff() < 0)) {
    answer.converged = false;
    while (!answer.converged && answer.sweeps < most_sweeps) {
      double change = 0;
      for (int i = 0; i < n; ++i) {
        const double before = answer.force[i];
        const double now = std::max(-tone, before - gap[i] / compliance_(i, i));
        if (now == before) continue;
        answer.force[i] = now;
        gap += (now - before) * compliance_.col(i);
        change = std::max(change, std::abs(now - before) * compliance_(i, i));
      }
      ++answer.sweeps;
      answer.converged = change < tolerance;
    }
  }
  for (int i = 0; i < n; ++i) {
    answer.deepest = std::max(answer.deepest, -gap[i]);
    answer.pressed += std::max(answer.force[i], 0.0);
    answer.open += gap[i] > 1e-4;
  }
  return answer;
}

}  // namespace face
