#include "manipulators/face_fem/statics.h"

#include <Eigen/Dense>
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

}  // namespace face
