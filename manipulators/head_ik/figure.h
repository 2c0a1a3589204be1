#pragma once

#include <Eigen/Core>
#include <string>

#include "manipulators/head_ik/neck.h"

namespace head {

/// A neck as ordinary `joint` objects: every level three Denavit-Hartenberg joints NAME_flexion, NAME_lateral,
/// NAME_axial, then the node `head`. Because the three axes of a level meet in its centre and stand at right angles,
/// every row has theta0 = -90 deg and alpha = 90 deg, and the way up and forward to the next centre is d and -a of the
/// axial row. A quarter turn about Y brings the first axis to X and another one brings the head's frame back.
struct FigureNames {
  std::string prefix = "neck_";
  std::string parent = "thorax";  ///< the node below which the first joint stands
  std::string head = "head";
};

/// The lines `create joint ...` of the dialog manager's language, from bottom to top, ending with the head.
/// `position`: origin of the neck's frame (the centre of C7-T1) in the parent's frame [m].
std::string figure_script(const Neck& neck, const FigureNames& names, const Eigen::Vector3d& position);

/// The same rows as a table of the documentation: joint, theta0, d, a, alpha, limits in degrees and metres.
std::string figure_table(const Neck& neck, const FigureNames& names);

/// Shortest decimal form that reads back to the same bits.
std::string number(double value);

}  // namespace head
