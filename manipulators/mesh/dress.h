#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "manipulators/mesh/result.h"
#include "manipulators/mesh/skin.h"

namespace mesh {

/// A piece of clothing, or of paint, as a region of the skin: where `bones` hold at least half of the weight, and
/// inside every plane, and near one of the lines.
struct Garment {
  std::string name;
  std::vector<int> bones;                            ///< indices into Skin::bones; empty: all
  Eigen::MatrixX4d planes = Eigen::MatrixX4d(0, 4);  ///< inside where n . p + d >= 0; rows nx ny nz d, bind pose
  Eigen::MatrixX4d lines = Eigen::MatrixX4d(0, 4);   ///< a polyline of balls x y z r; a ball of radius 0 ends a line
  double thickness = 0;  ///< how far the cloth lies above the skin, metres; its edge is closed
  /// What hangs wide: cloth is thicker by max(0, n . p + d); nx ny nz d, bind pose, metres per metre.
  Eigen::Vector4d flare = Eigen::Vector4d::Zero();
  int smoothing = 0;  ///< passes that even out, along the normals, what is under the cloth
};

/// Cuts the surface of `skin` along the borders of the garments (new vertices carry mixed weights, so borders are
/// straight and crisp, and tell of which vertices they are made) and makes each garment a part named after it; of two
/// that overlap the later one is seen. Faces outside all garments keep their parts. Errors: `range` a garment with a
/// bone that does not exist or a plane without a direction.
Result<Skin> dress(const Skin& skin, const std::vector<Garment>& garments);

}  // namespace mesh
