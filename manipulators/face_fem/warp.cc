#include "manipulators/face_fem/warp.h"

#include <Eigen/Dense>

namespace face {

Warp::Warp(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to) : from_(from) {
  const int n = int(from.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + 4, n + 4);
  Eigen::MatrixX3d b = Eigen::MatrixX3d::Zero(n + 4, 3);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) A(i, j) = (from[i] - from[j]).norm();
    A(i, n) = A(n, i) = 1;
    A.block<1, 3>(i, n + 1) = from[i].transpose();
    A.block<3, 1>(n + 1, i) = from[i];
    b.row(i) = to[i].transpose();
  }
  weight_ = A.fullPivLu().solve(b);
}

Eigen::Vector3d Warp::operator()(const Eigen::Vector3d& p) const {
  const Eigen::Index n = Eigen::Index(from_.size());
  Eigen::RowVector3d q = weight_.row(n) + p.transpose() * weight_.bottomRows<3>();
  for (Eigen::Index i = 0; i < n; ++i) q += (p - from_[i]).norm() * weight_.row(i);
  return q.transpose();
}

}  // namespace face
