#include "manipulators/mesh/skin.h"

#include <cassert>
#include <cmath>

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

/// Mixes the motions of bones at single vertices.
class Mixer {
 public:
  Mixer(const Skin& skin, const Eigen::MatrixX3f& rest, const std::vector<Eigen::Isometry3d>& pose, Blend blend)
      : skin_(skin), rest_(rest), linear_(blend == Blend::linear) {
    for (const Eigen::Isometry3d& motion : motions(skin, pose)) {
      if (linear_) {
        matrices_.push_back(motion.matrix().topRows<3>().cast<float>());
      } else {
        dual_.push_back(dual_quaternion(motion));
      }
    }
  }

  Eigen::RowVector3f at(Eigen::Index v) const { return linear_ ? by_matrices(v) : by_dual_quaternions(v); }

 private:
  Eigen::RowVector3f by_dual_quaternions(Eigen::Index v) const {
    const DualQuaternion& first = dual_[skin_.index(v, 0)];
    Eigen::Vector4f q = skin_.weight(v, 0) * first.q;
    Eigen::Vector4f e = skin_.weight(v, 0) * first.e;
    for (int i = 1; i < Skin::influences && skin_.weight(v, i) > 0; ++i) {
      // q and -q are the same rotation: take the one on the side of the strongest bone
      const DualQuaternion& other = dual_[skin_.index(v, i)];
      const float weight = first.q.dot(other.q) < 0 ? -skin_.weight(v, i) : skin_.weight(v, i);
      q += weight * other.q;
      e += weight * other.e;
    }
    const float scale = 1 / q.norm();
    q *= scale;
    e *= scale;
    const Eigen::Vector3f p = rest_.row(v).transpose();
    const Eigen::Vector3f r = q.head<3>();
    const Eigen::Vector3f rotated = p + 2 * r.cross(r.cross(p) + q[3] * p);
    const Eigen::Vector3f translation = 2 * (q[3] * e.head<3>() - e[3] * r + r.cross(e.head<3>()));
    return (rotated + translation).transpose();
  }

  Eigen::RowVector3f by_matrices(Eigen::Index v) const {
    Eigen::Matrix<float, 3, 4> mixed = skin_.weight(v, 0) * matrices_[skin_.index(v, 0)];
    for (int i = 1; i < Skin::influences && skin_.weight(v, i) > 0; ++i) {
      mixed += skin_.weight(v, i) * matrices_[skin_.index(v, i)];
    }
    return (mixed.leftCols<3>() * rest_.row(v).transpose() + mixed.col(3)).transpose();
  }

  const Skin& skin_;
  const Eigen::MatrixX3f& rest_;
  bool linear_;
  std::vector<DualQuaternion> dual_;
  std::vector<Eigen::Matrix<float, 3, 4>> matrices_;
};

}  // namespace

void deform(const Skin& skin, const Eigen::MatrixX3f& rest, const std::vector<Eigen::Isometry3d>& pose,
            Eigen::MatrixX3f& V, Eigen::MatrixX3f& N, Blend blend) {
  assert(pose.size() == skin.bones.size() && rest.rows() == skin.index.rows());
  V.resize(rest.rows(), 3);
  const Mixer mixer(skin, rest, pose, blend);
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    V.row(v) = mixer.at(v);
  }
  vertex_normals(V, skin.surface.F, skin.weld, N);
}

void deform(const Skin& skin, const std::vector<Eigen::Isometry3d>& pose, Eigen::MatrixX3f& V, Eigen::MatrixX3f& N,
            Blend blend) {
  deform(skin, skin.surface.V, pose, V, N, blend);
}

void deform_patch(const Skin& skin, const Eigen::MatrixX3f& rest, const std::vector<Eigen::Isometry3d>& pose,
                  const Patch& patch, Eigen::MatrixX3f& V, Eigen::MatrixX3f& N, Blend blend) {
  assert(pose.size() == skin.bones.size() && V.rows() == rest.rows() && N.rows() == rest.rows());
  const Mixer mixer(skin, rest, pose, blend);
  for (int v : patch.moved) {
    V.row(v) = mixer.at(v);
  }
  vertex_normals(V, skin.surface.F, skin.weld, patch, N);
}

}  // namespace mesh
