#pragma once

#include <vector>

#include "manipulators/face_fem/statics.h"

namespace face {

/// Displacements of unit loads, so that a frame is their weighted sum: exact (the model is linear) and without a solve.
/// Columns are muscles at activation 1, or bones moved by a unit step; a column whose muscle is dragged is replaced at
/// the cost of one solve.
class Basis {
 public:
  /// `nodes` are those a frame moves, usually skin_nodes(model).
  Basis(const Statics& statics, std::vector<int> nodes);

  /// Adds a column for each load (newtons, 3 by #nodes), all solved together. Returns the number of the first.
  int add(const std::vector<Field>& loads);
  /// Adds one column for supports that move by `shift` (3 by #nodes, held axes are read), without load.
  int add_shift(const Field& shift);
  /// Solves one column anew.
  void replace(int column, const Field& load);

  int columns() const { return static_cast<int>(full_.size()); }
  const std::vector<int>& nodes() const { return nodes_; }

  /// The frame: displacement of nodes() for the given amounts (#columns), metres, x y z in turn, 3 #nodes() floats.
  /// Zero amounts cost nothing.
  void frame(const double* amounts, float* displacement) const;
  /// The same of every node, in double precision.
  Field field(const double* amounts) const;
  /// One column over all nodes.
  const Field& column(int c) const { return full_[c]; }

 private:
  void keep(int column);

  const Statics& statics_;
  std::vector<int> nodes_;
  std::vector<Field> full_;
  std::vector<float> kept_;  // columns of 3 #nodes(), one after the other, padded to stride_
  std::size_t stride_;
};

}  // namespace face
