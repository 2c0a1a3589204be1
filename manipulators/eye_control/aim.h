#pragma once

#include <Eigen/Geometry>

#include "manipulators/eye_control/vec2.h"

namespace eye {

/// Where both eyes point, in the frame of the head (Y up, +Z forward, the person's left at +X).
///
/// Helmholtz angles: first up by `version.y` about the line through both eyes, then right by `version.x` within the
/// plane so raised. A point fixated by both eyes has the same elevation for both, so vergence is purely horizontal:
/// left azimuth = version.x + vergence / 2, right azimuth = version.x - vergence / 2 (Hering's law).
struct Aim {
  Vec2 version;         ///< mean azimuth (right positive) and elevation (up positive), rad
  double vergence = 0;  ///< left azimuth minus right azimuth, rad; 0 for far, positive for near
  bool beyond = false;  ///< the target lies outside the oculomotor range: this is the nearest aim inside it
};

/// A target as a direction with an inverse distance, so that "far" is an ordinary value.
struct Sight {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector from the middle of the eyes
  double nearness = 0;                                   ///< 1 / distance, 1/m; 0 is far
};

/// The head: rotation from its frame to the world's and the middle of the eyes, m.
struct HeadPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// Unit vector of Fick angles (azimuth about the vertical, right positive; then elevation, up positive).
/// A person facing +Z has the right hand at -X, so azimuth is a rotation about -Y.
Eigen::Vector3d fick_direction(Vec2 angles);

/// Fick angles of a direction; elevation in [-pi/2, pi/2], azimuth in (-pi, pi].
Vec2 fick_angles(const Eigen::Vector3d& direction);

/// Rotation that turns +Z to `fick_direction(angles)` with no roll: first azimuth about -Y, then elevation about -X.
Eigen::Quaterniond fick_rotation(Vec2 angles);

/// Unit vector of Helmholtz angles.
Eigen::Vector3d helmholtz_direction(Vec2 angles);

/// Helmholtz angles of a direction in front of the head (azimuth in [-pi/2, pi/2]).
Vec2 helmholtz_angles(const Eigen::Vector3d& direction);

/// The point seen from the head; a point in the middle of the eyes is taken as far ahead.
Sight sight_of_point(const Eigen::Vector3d& point, const HeadPose& head);

/// The world direction (a target at `nearness`) seen from a head that only turns.
Sight sight_of_direction(const Eigen::Vector3d& direction, double nearness, const HeadPose& head);

/// The aim of two eyes `eye_distance` apart on a target seen from the head; limited to the cone of half angle `range`
/// about straight ahead (a target exactly behind is approached by the right).
Aim aim_at(const Sight& target, double eye_distance, double range);

/// `version` moved to the nearest direction within the cone of half angle `range` about straight ahead.
Vec2 within_range(Vec2 version, double range);

/// Versions of less than the root of this length are within the range for certain, without any trigonometry.
inline double near_range2(double range) { return 0.8 * range * range; }

/// Angle between straight ahead and the direction of Helmholtz angles, rad.
double eccentricity(Vec2 version);

/// Orientation of an eye relative to the head that looks along `direction`, by Listing's law: the rotation from the
/// primary direction about an axis perpendicular to it. The primary direction is straight ahead turned right by
/// `primary_azimuth`. With 0 the quaternion has no z component at all (Tweed & Vilis).
Eigen::Quaterniond listing(const Eigen::Vector3d& direction, double primary_azimuth = 0);

/// Torsion of an orientation in Listing's coordinates: the component of the rotation vector along straight ahead, rad,
/// clockwise as the person sees it (the eye's top towards the person's right) positive.
double torsion(const Eigen::Quaterniond& orientation);

}  // namespace eye
