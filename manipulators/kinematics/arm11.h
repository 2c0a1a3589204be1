#pragma once

#include <array>

#include "manipulators/kinematics/chain.h"

namespace kinematics {

enum class Side { right, left };

/// The freedoms of the paper's arm in order: sternoclavicular, acromioclavicular, glenohumeral, elbow, forearm.
constexpr std::array<const char*, 11> arm11_names = {"sc_y", "sc_z", "sc_x",  "ac_y", "ac_z", "ac_x",
                                                     "gh_y", "gh_z", "gh_yy", "el_x", "ps_y"};

/// Stature [m] of the person whose arm the table describes, from the humerus and forearm lengths (0.291 and 0.244 m)
/// and Drillis and Contini's fractions of stature (0.186 and 0.146; the two give 1.565 and 1.671).
constexpr double arm11_stature = 1.618;

/// The five-link, eleven-freedom arm: girdle, humerus, forearm. Its base frame is the thorax of the Dutch shoulder and
/// elbow model: x right, y up, z back, origin at the incisura jugularis; the tool is the wrist with the frame of the
/// hand. All joints 0 is outside the limits: start from rest. Geometry: Denavit-Hartenberg table computed from the axis
/// lines of DAS3 (Chadwick, Blana, van den Bogert). Limits: DAS3, with gh_y and gh_yy narrowed to a human box (gh_y
/// -90..100, gh_yy -130..90 degrees); `wide` keeps DAS3's -170..175 and -177..179.
Chain arm11(Side side = Side::right, bool wide = false);

/// Carries the thorax frame of the arm (x right, y up, z back) into a body frame (x left, y up, z forward): half a turn
/// about y.
Eigen::Matrix3d body_from_thorax();

}  // namespace kinematics
