#include "manipulators/face_fem/lids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace face {

LidPath::LidPath(const Model& model, const Slit& slit, const Eyeball& eye, const Eigen::Vector3d& axis,
                 const std::vector<bool>& held)
    : centre_(eye.centre), axis_(axis) {
  forward_ = (Eigen::Vector3d::UnitZ() - axis_.z() * axis_).normalized();
  up_ = forward_.cross(axis_);
  double widest = 0;
  for (const SlitPair& pair : slit.pairs) {
    const int node[2] = {pair.upper, pair.lower};
    const Cylindrical end[2] = {coordinates(model.nodes[std::size_t(pair.upper)]),
                                coordinates(model.nodes[std::size_t(pair.lower)])};
    widest = std::max(widest, end[0].angle - end[1].angle);
    for (int lid : {0, 1}) {
      if (held[std::size_t(node[lid])]) continue;
      nodes_[std::size_t(lid)].push_back(node[lid]);
      from_[std::size_t(lid)].push_back(end[lid]);
      to_[std::size_t(lid)].push_back(end[1 - lid]);
    }
  }
  if (widest > 0) aperture_ = widest;
}

LidPath::Cylindrical LidPath::coordinates(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d r = p - centre_;
  const double y = r.dot(up_), z = r.dot(forward_);
  return {r.dot(axis_), std::hypot(y, z), std::atan2(y, z)};
}

Eigen::Vector3d LidPath::place(const Cylindrical& c) const {
  return centre_ + c.along * axis_ + c.radius * (std::sin(c.angle) * up_ + std::cos(c.angle) * forward_);
}

Eigen::Matrix3Xd LidPath::shift(int lid, double part) const {
  const auto& from = from_[std::size_t(lid)];
  const auto& to = to_[std::size_t(lid)];
  Eigen::Matrix3Xd shift(3, Eigen::Index(from.size()));
  for (std::size_t k = 0; k < from.size(); ++k) {
    const auto between = [&](double a, double b) { return a + part * (b - a); };
    const Cylindrical now{between(from[k].along, to[k].along), between(from[k].radius, to[k].radius),
                          between(from[k].angle, to[k].angle)};
    shift.col(Eigen::Index(k)) = place(now) - place(from[k]);
  }
  return shift;
}

std::array<double, LidPath::samples> LidPath::weights(int lid, double part) {
  const auto& at = lid == 0 ? upper_samples : lower_samples;
  std::array<double, samples> weight{};
  if (part == 0) return weight;
  for (std::size_t i = 0; i < samples; ++i) {
    double product = part / at[i];
    for (std::size_t j = 0; j < samples; ++j)
      if (j != i) product *= (part - at[j]) / (at[i] - at[j]);
    weight[i] = product;
  }
  return weight;
}

}  // namespace face
