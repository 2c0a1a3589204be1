#pragma once

#include <Eigen/Core>

namespace kinematics {

/// A rigid transform X_AB: the pose of frame B in frame A. `R` (3x3, proper) turns vectors of B into A,
/// `p` [m] is the origin of B in A.
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

/// X_AC = X_AB * X_BC.
Pose operator*(const Pose& X_AB, const Pose& X_BC);
Pose inverse(const Pose& X);
Eigen::Vector3d operator*(const Pose& X_AB, const Eigen::Vector3d& p_B);

/// Right-handed rotations about the axes of a frame, `angle` [rad].
Eigen::Matrix3d rotation_x(double angle);
Eigen::Matrix3d rotation_y(double angle);
Eigen::Matrix3d rotation_z(double angle);
/// Rotation about a unit `axis`.
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle);

/// The rotation vector (axis times angle, 0 <= angle <= pi) of R, through its quaternion: exact to rounding at every
/// angle, zero and the half turn included.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R);

/// Angle [rad] between two orientations, without the 1e-8 floor of acos near zero.
double rotation_distance(const Eigen::Matrix3d& R_a, const Eigen::Matrix3d& R_b);

/// Unit quaternions, order w x y z, w >= 0.
Eigen::Matrix3d rotation_from_quaternion(const Eigen::Vector4d& wxyz);
Eigen::Vector4d quaternion(const Eigen::Matrix3d& R);

/// Largest departure of R from a proper rotation: max |R^T R - 1|, or 2 when it is a reflection.
double rotation_defect(const Eigen::Matrix3d& R);

}  // namespace kinematics
