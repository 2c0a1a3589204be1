#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "manipulators/mesh/figure/axes.h"
#include "manipulators/mesh/figure/landmarks.h"
#include "manipulators/mesh/skin.h"

namespace figure {

/// A node or joint of the figure, as `create node` and `create joint` make it.
struct Part {
  std::string name;
  std::string parent;                                        ///< empty: the actor itself
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();  ///< position and orientation below the parent
  bool is_joint = false;
  Dh dh;
  double lower = 0, upper = 0;  ///< limits of the angle, rad
  double rest = 0;              ///< the posture the null space returns to
  double stand = 0;             ///< the angle the figure starts with: standing at ease
  double bind = 0;              ///< the angle at which the skeleton fits the body as it is in its file
};

/// A rigid segment of the skin.
struct Segment {
  std::string name;
  std::string parent;        ///< the part it moves with
  Eigen::Vector3d from, to;  ///< in the parent's frame, metres
  double radius;
  std::string twist_from;  ///< segment whose twist it takes over in part; empty: none
  double twist = 1;
  Eigen::Isometry3d bind = Eigen::Isometry3d::Identity();  ///< the parent's frame in the body's frame at bind time
};

/// What the scaled arm needs to be known by: factors on the segments of the Dutch shoulder and elbow model.
struct ArmScale {
  double girdle = 1, humerus = 1, forearm = 1;
};

/// The whole figure: parts, parents before children, and segments.
struct Skeleton {
  std::vector<Part> parts;
  std::vector<Segment> segments;
  ArmScale arm_scale;
  double fit_error = 0;  ///< largest distance of an elbow, wrist, knee or ankle from its landmark at bind time, metres
};

/// Frames of all parts in the actor's frame, each joint at the angle that `angle` gives it.
std::map<std::string, Eigen::Isometry3d> frames(const Skeleton& skeleton,
                                                const std::function<double(const Part&)>& angle);

/// Where the neck's joints stand and how large it is, so that the skull comes to its landmark.
struct NeckPlace {
  double scale = 1;
  Eigen::Vector3d position;  ///< of the disc C7-T1 in the thorax frame, metres
};

/// The place of a neck whose skull stands `rise` (up and forward, metres) above C7-T1 at scale 1.
NeckPlace neck_place(const Landmarks& landmarks, const Eigen::Vector3d& rise);

/// Reads the lines `create joint NAME parent P [position x y z] [orientation w x y z] dh t d a l lower l upper u` and
/// `create node ...` that head_ik prints for a neck. Error `syntax` with the line.
mesh::Result<std::vector<Part>> read_parts(const std::string& script);

/// The skeleton of a body: lengths from its landmarks, axes and ranges from the sources named in skeleton.cc. `neck`
/// are the joints from thorax to head, as read_parts() gives them for neck_place().
Skeleton make_skeleton(const Landmarks& landmarks, const std::vector<Part>& neck);

/// The skeleton's segments as bones of a skin, in the order of their names (as the renderer finds them).
std::vector<mesh::Bone> bones(const Skeleton& skeleton);

/// The frames of those bones, for deform(), with each joint at the angle that `angle` gives it.
std::vector<Eigen::Isometry3d> bone_pose(const Skeleton& skeleton, const std::function<double(const Part&)>& angle);

}  // namespace figure
