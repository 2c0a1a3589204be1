#pragma once

#include <array>
#include <optional>
#include <span>

#include "manipulators/arm_ik/girdle.h"
#include "manipulators/kinematics/arm11.h"

namespace arm_ik {

/// Joint angles by the recommendation of the International Society of Biomechanics (Wu et al. 2005), radians, the left
/// arm by its mirror image: shoulder against the thorax y-x-y (plane of elevation, elevation: negative when raised,
/// axial rotation: internal positive), elbow z-x-y (flexion, carrying, pronation).
struct IsbAngles {
  double plane = 0, elevation = 0, axial = 0;
  double flexion = 0, carrying = 0, pronation = 0;
};

/// A chain seen as the eleven-freedom human arm: what limb and rhythm need to know. All frames are those of the right
/// arm; a left arm is solved as its mirror image.
class HumanArm {
 public:
  static constexpr int joints = 11, girdle = 6;

  /// The arm in a chain of any side and place, with links of any length and any limits, or nothing when the axes are
  /// not the arm's.
  static std::optional<HumanArm> recognize(const kinematics::Chain& chain);

  kinematics::Side side() const { return side_; }
  const kinematics::Chain& chain() const { return chain_; }  ///< right-handed
  /// The thorax frame (x right, y up, z back) in the chain's surroundings.
  const Eigen::Matrix3d& thorax() const { return thorax_; }
  /// A pose of the surroundings, mirrored when the arm is a left one.
  kinematics::Pose mirrored(const kinematics::Pose& X) const;

  /// The girdle that goes with a humerus direction, inside the limits of the arm's own joints.
  GirdleAngles girdle_of(double plane, double elevation) const;

  /// Orientation of the humerus against the thorax, identity when all joints are zero.
  Eigen::Matrix3d humerus(std::span<const double> q) const;
  /// Plane of elevation and elevation [rad] of a humerus against the thorax. At zero elevation the plane is `fallback`.
  static std::array<double, 2> direction(const Eigen::Matrix3d& humerus, double fallback);

  IsbAngles isb(std::span<const double> q) const;

 private:
  kinematics::Chain chain_;
  kinematics::Side side_ = kinematics::Side::right;
  Eigen::Matrix3d thorax_, humerus_offset_, forearm_offset_;
};

}  // namespace arm_ik
