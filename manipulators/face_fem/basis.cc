#include "manipulators/face_fem/basis.h"

#include <algorithm>

#include "manipulators/face_fem/column_sum.h"

namespace face {

Basis::Basis(const Statics& statics, std::vector<int> nodes)
    : statics_(statics), nodes_(std::move(nodes)), stride_(3 * nodes_.size()) {}

int Basis::add(const std::vector<Field>& loads) {
  const int first = columns();
  if (loads.empty()) return first;
  const Eigen::Index length = loads[0].size();
  Eigen::MatrixXd all(length, Eigen::Index(loads.size()));
  for (std::size_t c = 0; c < loads.size(); ++c)
    all.col(Eigen::Index(c)) = Eigen::Map<const Eigen::VectorXd>(loads[c].data(), length);
  statics_.factor().solve_all(all);
  for (std::size_t c = 0; c < loads.size(); ++c) {
    full_.emplace_back(Eigen::Map<const Field>(all.col(Eigen::Index(c)).data(), 3, length / 3));
    keep(first + int(c));
  }
  return first;
}

int Basis::add_shift(const Field& shift) {
  full_.push_back(statics_.solve(Field::Zero(3, shift.cols()), shift).u);
  keep(columns() - 1);
  return columns() - 1;
}

void Basis::replace(int column, const Field& load) {
  full_[column] = statics_.factor().solve(load);
  keep(column);
}

void Basis::keep(int column) {
  kept_.resize(stride_ * full_.size());
  float* to = kept_.data() + stride_ * column;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    for (int i = 0; i < 3; ++i) to[3 * k + i] = float(full_[column](i, nodes_[k]));
}

void Basis::frame(const double* amounts, float* displacement) const {
  std::fill(displacement, displacement + stride_, 0.0f);
  std::vector<const float*> active;
  std::vector<float> amount;
  for (int c = 0; c < columns(); ++c)
    if (amounts[c] != 0) {
      active.push_back(kept_.data() + stride_ * c);
      amount.push_back(float(amounts[c]));
    }
  add_columns(active.data(), amount.data(), int(active.size()), stride_, displacement);
}

Field Basis::field(const double* amounts) const {
  Field sum = Field::Zero(3, int(statics_.model().nodes.size()));
  for (int c = 0; c < columns(); ++c)
    if (amounts[c] != 0) sum += amounts[c] * full_[c];
  return sum;
}

}  // namespace face
