#pragma once

#include <Eigen/Core>
#include <array>

namespace arm_ik {

/// Sternoclavicular and acromioclavicular angles [rad] in the order of the arm's joints: SC y z x, AC y z x; the
/// rotations are about current axes of frames that are parallel to the thorax at zero (x right, y up, z back).
using GirdleAngles = std::array<double, 6>;

/// Clavicle and scapula follow the humerus: the regression of de Groot and Brand (Clin Biomech 16:735, 2001; ten
/// persons, 23 postures) from the plane of elevation and the elevation of the humerus against the thorax [rad] (y-z-y
/// sequence: plane 0 is sideways, pi/2 forwards). The regression leaves the clavicle's turn about its own axis open; it
/// is the one that turns the acromioclavicular joint least away from rest, in closed form.
GirdleAngles rhythm(double plane, double elevation);

/// Orientation of the scapula against the thorax in that posture.
Eigen::Matrix3d scapula_of(const GirdleAngles& angles);

/// Upward rotation of the scapula [rad] per radian of humeral elevation in the regression, constant.
double scapular_share();

}  // namespace arm_ik
