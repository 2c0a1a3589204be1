#include "manipulators/face_fem/statics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/clock.h"

namespace face {
namespace {

Error with_label(Error error, const Model& model) {
  if (error.node >= 0)
    error.sentence = "at node " + std::to_string(model.label_of_node(error.node)) + ": " + error.sentence;
  // reduced integration is the one element whose bricks have modes of their own
  const bool numeric = error.fault == Fault::indefinite || error.fault == Fault::conditioning;
  if (numeric && model.element == Element::hex20r)
    return {Fault::zero_mode, error.sentence + " (hex20r has a spare mode in rows one element wide; use hex20)",
            error.node};
  return error;
}

}  // namespace

std::vector<std::array<bool, 3>> held_axes(const Model& model) {
  std::vector<std::array<bool, 3>> held(model.nodes.size(), {false, false, false});
  for (const Support& support : model.supports) held[support.node] = support.held;
  return held;
}

Field given_shifts(const Model& model) {
  Field shift = Field::Zero(3, static_cast<int>(model.nodes.size()));
  for (const Support& support : model.supports)
    for (int i = 0; i < 3; ++i)
      if (support.held[i]) shift(i, support.node) = support.shift[i];
  return shift;
}

Result<Statics> Statics::make(Model model, const FactorOptions& options) {
  if (auto status = check(model); !status) return status.error();
  Statics statics;
  statics.model_ = std::move(model);
  const double begin = cpu_seconds();
  auto K = assemble(statics.model_);
  if (!K) return K.error();
  statics.stiffness_ = std::move(*K);
  statics.assemble_seconds_ = cpu_seconds() - begin;
  statics.held_ = held_axes(statics.model_);
  auto factor = Factor::make(statics.stiffness_, statics.held_, options);
  if (!factor) return with_label(factor.error(), statics.model_);
  statics.factor_ = std::make_unique<Factor>(std::move(*factor));
  return statics;
}

Solution Statics::solve(const Field& load) const { return solve(load, given_shifts(model_)); }

Solution Statics::solve(const Field& load, const Field& shift) const {
  Solution solution;
  const double begin = cpu_seconds();
  Field given = Field::Zero(3, load.cols());
  bool moved = false;
  for (const Support& s : model_.supports)
    for (int i = 0; i < 3; ++i)
      if (s.held[i]) {
        given(i, s.node) = shift(i, s.node);
        moved = moved || shift(i, s.node) != 0;
      }
  Field pull = load;
  if (moved) pull -= multiply(stiffness_, given);
  solution.u = factor_->solve(pull) + given;
  solution.seconds = cpu_seconds() - begin;

  const Field left = multiply(stiffness_, solution.u) - load;
  solution.reaction = Field::Zero(3, load.cols());
  double miss = 0, size = 0;
  for (int n = 0; n < load.cols(); ++n)
    for (int i = 0; i < 3; ++i) {
      if (held_[n][i]) {
        solution.reaction(i, n) = left(i, n);
      } else {
        miss += left(i, n) * left(i, n);
        size += pull(i, n) * pull(i, n);
      }
    }
  solution.residual = size > 0 ? std::sqrt(miss / size) : std::sqrt(miss);
  return solution;
}

Status Statics::stiffen(int hexahedron, double ratio) {
  if (hexahedron < 0 || hexahedron >= int(model_.hexahedra.size()))
    return Error{Fault::unknown, "there is no element with index " + std::to_string(hexahedron)};
  if (!std::isfinite(ratio) || ratio <= 0)
    return Error{Fault::material, "element " + std::to_string(model_.label_of_hexahedron(hexahedron)) +
                                      ": its stiffness can change by a positive ratio only, not by " +
                                      std::to_string(ratio)};
  if (ratio_.empty()) ratio_.assign(model_.hexahedra.size(), 1.0);
  const double change = ratio_[hexahedron] * (ratio - 1);
  if (change == 0) return success();
  ratio_[hexahedron] *= ratio;
  add_element(model_, hexahedron, change, stiffness_);
  const Hexahedron& h = model_.hexahedra[hexahedron];
  const int count = nodes_of(model_.element);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      stiffness_of(model_.element, corners_of(model_, hexahedron), model_.materials[h.material].lame()));
  // rigid motions have no stiffness and need no update
  const double largest = eigen.eigenvalues()[3 * count - 1];
  int first = 0;
  while (eigen.eigenvalues()[first] < 1e-12 * largest) ++first;
  const int rank = 3 * count - first;
  Eigen::MatrixXd W = eigen.eigenvectors().rightCols(rank);
  for (int r = 0; r < rank; ++r) W.col(r) *= std::sqrt(std::abs(change) * eigen.eigenvalues()[first + r]);
  // a wedge names a node twice: its rows add up
  std::vector<int> nodes;
  Eigen::MatrixXd rows(3 * count, rank);
  for (int a = 0; a < count; ++a) {
    const auto known = std::find(nodes.begin(), nodes.end(), h.node[a]);
    const Eigen::Index at = 3 * (known - nodes.begin());
    if (known != nodes.end()) {
      rows.middleRows(at, 3) += W.middleRows(3 * a, 3);
    } else {
      rows.middleRows(at, 3) = W.middleRows(3 * a, 3);
      nodes.push_back(h.node[a]);
    }
  }
  const Status status = factor_->update(nodes, rows.topRows(3 * Eigen::Index(nodes.size())), change > 0 ? 1 : -1);
  return status ? success() : with_label(status.error(), model_);
}

}  // namespace face
