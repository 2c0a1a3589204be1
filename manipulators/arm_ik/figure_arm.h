#pragma once

#include <string>

#include "manipulators/kinematics/arm11.h"

namespace arm_ik {

/// The arm as ordinary objects of a figure: eleven `joint` objects, the node of the hand and the `arm` that moves them,
/// all flat below `actor` and linked by `parent`.
struct FigureArm {
  kinematics::Side side = kinematics::Side::right;
  std::string actor = "sailor";
  std::string parent = "thorax";  ///< object of the actor that carries the arm; x left, y up, z forward
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the incisura jugularis in the parent's frame [m]
  double stature = kinematics::arm11_stature;          ///< [m]
};

/// The lines `create ...` of the dialog manager's language, degrees and metres.
std::string figure_script(const FigureArm& figure);

}  // namespace arm_ik
