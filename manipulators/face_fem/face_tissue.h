#pragma once

#include <vector>

#include "manipulators/face_fem/face.h"
#include "manipulators/face_fem/face_sheet.h"
#include "manipulators/face_fem/tissue_depth.h"

namespace face {

/// What tissue rests on at the inner end of a stack.
enum class Bed {
  skull,  ///< fixed
  jaw,    ///< moves with the mandible
  free,   ///< nothing: inside of lips and cheeks, fat of the orbit, below the jaw's border
  eye,    ///< slides over the eyeball
};

/// Tissue stacked on a sheet.
struct FaceTissue {
  Model model;
  std::vector<double> inner;           ///< radius of the inner end of each stack, metres
  std::vector<Bed> bed;                ///< of each stack
  std::vector<std::vector<int>> node;  ///< of each stack, from the inner end to the skin: layers + 1 nodes
};

/// Fills the space between the sheet and the bone with `options.layers` hexahedra a stack: deep tissue, fat, skin
/// (15, 5, 60 kPa), the skin 1.8 mm thick or a third of what there is. Between lids and eyeball lies a film of 1 mm,
/// soft in shear and nearly incompressible, which lets the lids slide but not leave the ball. Bone lies where a ball of
/// the tissue's depth, rolled along the inside of the skin, reaches (TissueDepth), so depth is square to the skin.
/// Stacks run along rays, so no element folds.
FaceTissue stack_tissue(const Head& head, const Landmarks& marks, const FaceSheet& sheet, const FaceOptions& options);

/// Radius of the bone under a smooth skin on the ray of a chart point: the depth's ball rolled along `skin`.
double bone_radius(const FaceChart& chart, const ChartPoint& c, double depth, const std::vector<Eigen::Vector3d>& skin);

}  // namespace face
