#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "manipulators/mesh/result.h"
#include "manipulators/mesh/surface.h"

namespace figure {

/// Joint centres and landmarks of the left half of a body that stands on y = 0 and faces +Z, symmetrical in x = 0,
/// metres. The right half is the mirror image. Where a rule uses a proportion its source is named in landmarks.cc.
struct Landmarks {
  double stature;
  Eigen::Vector3d eye;        ///< centre of the eyeball
  double eye_radius;          ///< of the eyeball
  Eigen::Vector3d skull;      ///< where the skull turns on the first vertebra (C0-C1)
  Eigen::Vector3d neck_base;  ///< disc between C7 and T1
  Eigen::Vector3d shoulder;   ///< centre of the head of the humerus
  Eigen::Vector3d elbow, wrist;
  Eigen::Vector3d knuckle;    ///< of the middle finger
  Eigen::Vector3d fingertip;  ///< of the middle finger
  Eigen::Vector3d palm;       ///< unit normal out of the palm
  Eigen::Vector3d hip, knee, ankle;
  Eigen::Vector3d ball;                ///< of the foot, where the toes bend
  Eigen::Vector3d toe, heel;           ///< foremost and hindmost point of the foot
  std::vector<Eigen::Vector3d> spine;  ///< discs L5-S1, L3-L4, T12-L1, T7-T8
  Eigen::Vector3d sternum;             ///< the notch above the breastbone, on the skin
};

/// Finds the landmarks of `body` (parts named *eye* are the eyeballs, all others the skin) from plane sections.
/// Error `range` when the surface is not such a body: which landmark was not found, and why.
mesh::Result<Landmarks> find_landmarks(const mesh::Surface& body);

/// One line each: name and coordinates, in a fixed order.
std::string describe(const Landmarks& landmarks);

}  // namespace figure
