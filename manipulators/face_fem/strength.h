#pragma once

#include "manipulators/face_fem/face.h"

namespace face {

/// The face with muscles as strong, and as broad at the skin, as expressions need. A cross-section from a book and a
/// fibre without breadth pull too hard at too small a place: they turn elements inside out while the skin a centimetre
/// away hardly moves; and fibres that end beside the corner of the mouth, where flesh weaves them into a knot (the
/// modiolus) that a homogeneous tissue does not have, pull at the cheek instead. The table in strength.cc gives, by
/// muscle, a factor on the force, the radius of its ends in the tissue and how far its insertion is drawn to that knot;
/// it was fitted to the motion of ICT-FaceKit's expressions and to the 11 to 14 mm that the corner of a mouth
/// travels in a full smile.
Face strengthened(Face face);

}  // namespace face
