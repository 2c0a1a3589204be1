#pragma once

#include <vector>

#include "manipulators/face_fem/face_carrier.h"
#include "manipulators/face_fem/face_tissue.h"

namespace face {

/// Weights that carry tissue to the vertices of the head (FaceCarrier): on the chart each vertex has a place in the
/// sheet and a depth between skin and bone; across the sheet the nodes are interpolated by Catmull and Rom's cubics,
/// which are smooth (C1) over columns and rows, through the depth linearly. Vertices inside of the mouth pass from the
/// lips they hang on to the bone behind, those behind the lids come to rest; round the sheet the motion of its border
/// fades over `reach`. Lips and lids are told apart by the shortest way along the head's surface.
std::vector<FaceCarrier::Row> bind_vertices(const Head& head, const Landmarks& marks, const FaceSheet& sheet,
                                            const FaceTissue& tissue, double reach);

}  // namespace face
