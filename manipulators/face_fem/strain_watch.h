#pragma once

#include <vector>

#include "manipulators/face_fem/basis.h"
#include "manipulators/face_fem/validity.h"

namespace face {

/// Strain of a frame without a pass over the nodes: the displacement gradient at the middle of every element is linear
/// in the amounts, so it is kept for each column and summed. Cheaper than validity_of() by about a hundred times; it
/// sees what an element does on the whole, not its corners.
class StrainWatch {
 public:
  /// Elements of the layer of that name are left out: the film between lid and eyeball stands for sliding, its shear
  /// has no meaning.
  explicit StrainWatch(const Model& model, const std::string& without = "film");

  /// The gradients of a column that was added or replaced.
  void read(const Model& model, const Field& u, int column);

  /// strain, strained_element, inverted, inverted_element (of the middles) at these amounts, all columns.
  Validity measure(const std::vector<double>& amounts) const;

 private:
  std::vector<int> elements_;                // those watched
  std::vector<std::vector<float>> columns_;  // 9 numbers by element, H(i, j) = du_i / dx_j row by row, rows apart
};

}  // namespace face
