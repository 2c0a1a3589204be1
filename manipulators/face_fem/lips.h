#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/face_fem/basis.h"
#include "manipulators/face_fem/face.h"

namespace face {

/// Lips that press on each other but never pass through, and that stay sealed until they part.
///
/// The force across each pair of nodes is an unknown of a small problem in the condensed compliance C of the pairs
/// (the answer of the whole model to unit forces, so nothing is lost): gap = gap_free + C force, with
///   force = -tone  and gap >= 0   (open, pulled by what is left of the seal)
///   force > -tone  and gap  = 0   (touching; a positive force presses)
/// the minimum of a convex quadratic with bounds, found by projected Gauss-Seidel, always from the same start, so an
/// answer depends on nothing but its input.
class LipContact {
 public:
  /// Adds a column for each pair to `basis`, at `first_column()` and after. Costs one solve a pair.
  LipContact(const Model& model, const Slit& slit, const std::vector<bool>& held, Basis& basis);

  int pairs() const { return int(pairs_.size()); }
  int first_column() const { return first_; }

  /// Call when columns before first_column() were added or replaced: reads what they do to the gaps.
  void read(const Basis& basis, int column);

  /// Adds what a force across pair `i` does to its two nodes.
  void add_load(int i, double force, Field& load) const;

  struct Answer {
    Eigen::VectorXd force;  ///< newtons, by pair: the amounts of the columns
    double deepest = 0;     ///< penetration that is left, metres
    double pressed = 0;     ///< sum of the forces that press, newtons
    int open = 0;           ///< pairs that do not touch
    int sweeps = 0;
    bool converged = true;
  };
  /// `amounts` of the columns before first_column(); `tone`: newtons that a pair holds before it parts, >= 0.
  Answer solve(const double* amounts, double tone) const;

  static constexpr double tolerance = 1e-6;  ///< metres of gap
  static constexpr int most_sweeps = 400;

 private:
  struct Pair {
    int upper, lower;
    Eigen::Vector3d normal;
    double gap;
  };
  double gap_of(const Pair& pair, const Field& u) const;

  std::vector<Pair> pairs_;
  int first_ = 0;
  Eigen::MatrixXd compliance_;  // #pairs by #pairs: gap of i by unit force at j
  Eigen::MatrixXd by_column_;   // #pairs by first_: gap of i by column c
};

}  // namespace face
