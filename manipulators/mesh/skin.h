#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "manipulators/mesh/normals.h"
#include "manipulators/mesh/origin.h"
#include "manipulators/mesh/result.h"
#include "manipulators/mesh/surface.h"

namespace mesh {

/// A rigid segment that moves the skin around it.
struct Bone {
  std::string name;
  Eigen::Isometry3d bind = Eigen::Isometry3d::Identity();  ///< the bone's frame in the surface's frame, at bind time
  Eigen::Vector3d from = Eigen::Vector3d::Zero();          ///< its axis, in its own frame, metres
  Eigen::Vector3d to = Eigen::Vector3d::Zero();            ///< `from` nearer to the trunk
  double radius = 0.05;                                    ///< about how far the skin is from the axis, metres
  int twist_from = -1;  ///< index of the bone whose rotation about the axis it takes over in part; -1: none
  double twist = 1;     ///< share of its own rotation about its axis against `twist_from`, in [0, 1]
};

/// A surface bound to bones: at most `influences` weights a vertex, non-negative, summing to one.
struct Skin {
  static constexpr int influences = 6;
  using Indices = Eigen::Matrix<int, Eigen::Dynamic, influences, Eigen::RowMajor>;
  using Weights = Eigen::Matrix<float, Eigen::Dynamic, influences, Eigen::RowMajor>;

  Surface surface;          ///< in the bind pose
  std::vector<Bone> bones;  ///< #B
  Indices index;            ///< #V by influences, bone of each weight (0 where the weight is 0)
  Weights weight;           ///< #V by influences, falling from left to right
  Eigen::VectorXi weld;     ///< #V, from welded(); used for normals
  Origin origin;            ///< #V, in terms of the vertices of the surface that was bound
};

/// How transforms are mixed where several bones pull at a vertex.
enum class Blend {
  dual_quaternion,  ///< Kavan et al. 2008: keeps volume at bent elbows and twisted forearms
  linear,           ///< the classic; collapses under twist, kept for comparison
};

/// Binds `surface` to `bones`: weights are the stationary heat left by each bone on the surface
/// (Baran and Popovic 2007: a vertex is heated by the bones it can see through the inside of the body, and the heat
/// spreads along the surface), so nothing bleeds from arm to trunk or from leg to leg across a gap.
/// Cost: one sparse factorisation and one solve per bone, once. Errors: `range` no bones, no vertices, a bone that is
/// not finite or a `twist_from` that is no bone.
Result<Skin> bind_skin(Surface surface, std::vector<Bone> bones);

/// Moves the skin: `pose[b]` is the frame of bone b now, in any frame; V and N come out in that same frame.
/// V and N are resized to #V by 3. With pose[b] = bind[b] for all b the surface comes back to rounding.
void deform(const Skin& skin, const std::vector<Eigen::Isometry3d>& pose, Eigen::MatrixX3f& V, Eigen::MatrixX3f& N,
            Blend blend = Blend::dual_quaternion);

/// As above for a skin whose vertices are at `rest` (#V by 3, bind pose) instead of at skin.surface.V: a face that has
/// an expression.
void deform(const Skin& skin, const Eigen::MatrixX3f& rest, const std::vector<Eigen::Isometry3d>& pose,
            Eigen::MatrixX3f& V, Eigen::MatrixX3f& N, Blend blend = Blend::dual_quaternion);

/// Brings V and N, made by deform() in the same pose, up to date after `rest` has changed at the vertices of `patch`
/// (patch_around(), normals.h). The same bits as deform(), at the cost of the patch alone.
void deform_patch(const Skin& skin, const Eigen::MatrixX3f& rest, const std::vector<Eigen::Isometry3d>& pose,
                  const Patch& patch, Eigen::MatrixX3f& V, Eigen::MatrixX3f& N, Blend blend = Blend::dual_quaternion);

}  // namespace mesh
