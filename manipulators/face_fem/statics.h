#pragma once

#include <memory>
#include <string>
#include <vector>

#include "manipulators/face_fem/factor.h"
#include "manipulators/face_fem/model.h"

namespace face {

/// An answer with its error.
struct Solution {
  Field u;              ///< displacement, metres
  Field reaction;       ///< force of the supports on the tissue along held axes, newtons; zero elsewhere
  double residual = 0;  ///< |K u - f| / |f| over the free axes (f with the pull of given displacements)
  double seconds = 0;   ///< CPU time of the solve
};

/// A model that can be solved: checked, assembled and factored once; every load after that costs one solve.
class Statics {
 public:
  /// Errors: those of check(), assemble() and Factor::make(); a zero mode of hex20r is told as `zero_mode`.
  static Result<Statics> make(Model model, const FactorOptions& options = {});

  /// Displacement under `load` (newtons, 3 by #nodes) with the supports at their given shifts.
  Solution solve(const Field& load) const;
  /// With other shifts of the supports: `shift` is 3 by #nodes, read at held axes only.
  Solution solve(const Field& load, const Field& shift) const;

  /// Multiplies the stiffness of one element by `ratio` > 0 and updates the factor in place (rank 3n - 6 update, no
  /// new factorisation). Errors: `material` when ratio is not positive and finite, `unknown` no such element.
  Status stiffen(int hexahedron, double ratio);

  const Model& model() const { return model_; }
  const Stiffness& stiffness() const { return stiffness_; }
  const Factor& factor() const { return *factor_; }
  const std::vector<std::array<bool, 3>>& held() const { return held_; }
  double assemble_seconds() const { return assemble_seconds_; }

 private:
  Statics() = default;

  Model model_;
  Stiffness stiffness_;
  std::vector<std::array<bool, 3>> held_;
  std::unique_ptr<Factor> factor_;
  std::vector<double> ratio_;  // stiffness of each element against its material's
  double assemble_seconds_ = 0;
};

/// Three flags a node: held axes.
std::vector<std::array<bool, 3>> held_axes(const Model& model);

/// Displacements that the supports prescribe, 3 by #nodes, zero elsewhere.
Field given_shifts(const Model& model);

}  // namespace face
