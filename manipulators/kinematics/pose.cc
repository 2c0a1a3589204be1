#include "manipulators/kinematics/pose.h"

#include <Eigen/Geometry>
#include <cmath>

namespace kinematics {

Pose operator*(const Pose& X_AB, const Pose& X_BC) { return {X_AB.R * X_BC.R, X_AB.R * X_BC.p + X_AB.p}; }

Pose inverse(const Pose& X) { return {X.R.transpose(), -(X.R.transpose() * X.p)}; }

Eigen::Vector3d operator*(const Pose& X_AB, const Eigen::Vector3d& p_B) { return X_AB.R * p_B + X_AB.p; }

Eigen::Matrix3d rotation_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix3d() << 1, 0, 0, 0, c, -s, 0, s, c).finished();
}

Eigen::Matrix3d rotation_y(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix3d() << c, 0, s, 0, 1, 0, -s, 0, c).finished();
}

Eigen::Matrix3d rotation_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix3d() << c, -s, 0, s, c, 0, 0, 0, 1).finished();
}

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::Vector4d wxyz = quaternion(R);
  const Eigen::Vector3d v = wxyz.tail<3>();
  const double sine = v.norm();
  // angle / sin(angle / 2) tends to 2 at zero
  return sine < 1e-150 ? Eigen::Vector3d(2 * v) : Eigen::Vector3d(2 * std::atan2(sine, wxyz[0]) / sine * v);
}

double rotation_distance(const Eigen::Matrix3d& R_a, const Eigen::Matrix3d& R_b) {
  return rotation_vector(R_a.transpose() * R_b).norm();
}

Eigen::Matrix3d rotation_from_quaternion(const Eigen::Vector4d& wxyz) {
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

Eigen::Vector4d quaternion(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  const double sign = q.w() < 0 ? -1 : 1;
  return sign * Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

double rotation_defect(const Eigen::Matrix3d& R) {
  if (R.determinant() <= 0) return 2;
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace kinematics
