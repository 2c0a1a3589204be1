#include "manipulators/mesh/skin.h"

#include <cassert>
#include <cmath>

#include "manipulators/mesh/normals.h"

namespace mesh {
namespace {

/// Rigid motion as a unit dual quaternion, rotation `q` and dual part `e` = 1/2 t q (Kavan et al. 2008).
struct DualQuaternion {
  Eigen::Vector4f q, e;  ///< x y z w
};

DualQuaternion dual_quaternion(const Eigen::Isometry3d& motion) {
  const Eigen::Quaterniond q(motion.linear());
  const Eigen::Vector3d t = motion.translation();
  const Eigen::Quaterniond e = Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * q;
  return {q.coeffs().cast<float>(), (0.5 * e.coeffs()).cast<float>()};
}

/// The motion of bone b since bind time, its own rotation about its axis reduced to the share it takes.
Eigen::Isometry3d motion(const std::vector<Bone>& bones, const std::vector<Eigen::Isometry3d>& pose, std::size_t b) {
  const Bone& bone = bones[b];
  const Eigen::Isometry3d whole = pose[b] * bone.bind.inverse();
  const Eigen::Vector3d along = bone.bind.linear() * (bone.to - bone.from);
  if (bone.twist_from < 0 || bone.twist == 1 || along.norm() == 0) {
    return whole;
  }
  const std::size_t base = bone.twist_from;
  const Eigen::Isometry3d of_base = pose[base] * bones[base].bind.inverse();
  Eigen::Quaterniond relative((of_base.inverse() * whole).linear());
  if (relative.w() < 0) {
    relative.coeffs() = -relative.coeffs();
  }
  // swing times twist: turn back about the axis, as it lay at bind time, before everything else
  const Eigen::Vector3d axis = along.normalized();
  const double twist = 2 * std::atan2(relative.vec().dot(axis), relative.w());
  const Eigen::Vector3d point = bone.bind * bone.from;
  const Eigen::AngleAxisd back((bone.twist - 1) * twist, axis);
  return whole * Eigen::Translation3d(point) * back * Eigen::Translation3d(-point);
}

std::vector<Eigen::Isometry3d> motions(const Skin& skin, const std::vector<Eigen::Isometry3d>& pose) {
  std::vector<Eigen::Isometry3d> result;
  for (std::size_t b = 0; b < skin.bones.size(); ++b) {
    result.push_back(motion(skin.bones, pose, b));
  }
  return result;
}

void blend_dual_quaternions(const Skin& skin, const std::vector<Eigen::Isometry3d>& motion, Eigen::MatrixX3f& V) {
  std::vector<DualQuaternion> bones;
  for (const Eigen::Isometry3d& m : motion) {
    bones.push_back(dual_quaternion(m));
  }
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    const DualQuaternion& first = bones[skin.index(v, 0)];
    Eigen::Vector4f q = skin.weight(v, 0) * first.q;
    Eigen::Vector4f e = skin.weight(v, 0) * first.e;
    for (int i = 1; i < Skin::influences && skin.weight(v, i) > 0; ++i) {
      // q and -q are the same rotation: take the one on the side of the strongest bone
      const DualQuaternion& other = bones[skin.index(v, i)];
      const float weight = first.q.dot(other.q) < 0 ? -skin.weight(v, i) : skin.weight(v, i);
      q += weight * other.q;
      e += weight * other.e;
    }
    const float scale = 1 / q.norm();
    q *= scale;
    e *= scale;
    const Eigen::Vector3f p = skin.surface.V.row(v).transpose();
    const Eigen::Vector3f r = q.head<3>();
    const Eigen::Vector3f rotated = p + 2 * r.cross(r.cross(p) + q[3] * p);
    const Eigen::Vector3f translation = 2 * (q[3] * e.head<3>() - e[3] * r + r.cross(e.head<3>()));
    V.row(v) = (rotated + translation).transpose();
  }
}

void blend_linear(const Skin& skin, const std::vector<Eigen::Isometry3d>& motion, Eigen::MatrixX3f& V) {
  std::vector<Eigen::Matrix<float, 3, 4>> bones;
  for (const Eigen::Isometry3d& m : motion) {
    bones.push_back(m.matrix().topRows<3>().cast<float>());
  }
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    Eigen::Matrix<float, 3, 4> mixed = skin.weight(v, 0) * bones[skin.index(v, 0)];
    for (int i = 1; i < Skin::influences && skin.weight(v, i) > 0; ++i) {
      mixed += skin.weight(v, i) * bones[skin.index(v, i)];
    }
    V.row(v) = (mixed.leftCols<3>() * skin.surface.V.row(v).transpose() + mixed.col(3)).transpose();
  }
}

}  // namespace

void deform(const Skin& skin, const std::vector<Eigen::Isometry3d>& pose, Eigen::MatrixX3f& V, Eigen::MatrixX3f& N,
            Blend blend) {
  assert(pose.size() == skin.bones.size());
  V.resize(skin.surface.V.rows(), 3);
  const std::vector<Eigen::Isometry3d> motion = motions(skin, pose);
  if (blend == Blend::linear) {
    blend_linear(skin, motion, V);
  } else {
    blend_dual_quaternions(skin, motion, V);
  }
  vertex_normals(V, skin.surface.F, skin.weld, N);
}

}  // namespace mesh
