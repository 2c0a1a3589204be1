#pragma once

#include <vector>

#include "manipulators/face_fem/face.h"
#include "manipulators/face_fem/face_sheet.h"
#include "manipulators/face_fem/face_tissue.h"

namespace face {

/// Places all muscles of muscle_names in the tissue. Fibre ends that were published for one face are carried to this
/// one by a thin-plate spline through landmarks of both, then set to the depth where they belong: bone ends on the
/// bone, others inside the tissue, their spheres fitted to its thickness. Force of a muscle: its cross-section times
/// 100 kPa (a common maximum stress of skeletal muscle, used by the face model that the fibres come from), shared
/// equally by its strands.
void place_muscles(const Landmarks& marks, const FaceSheet& sheet, const FaceTissue& tissue,
                   std::vector<Muscle>& muscles, std::vector<MuscleNote>& notes);

}  // namespace face
