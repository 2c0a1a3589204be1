#include "manipulators/mesh/figure/axes.h"

#include <cassert>
#include <cmath>

namespace figure {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Some unit vector across `z`.
Vector3d across(const Vector3d& z) {
  const Vector3d other = std::abs(z.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  return (other - other.dot(z) * z).normalized();
}

/// The common normal from axis g to axis h: its unit direction and its foot on h.
struct Normal {
  Vector3d direction, foot;
};

Normal common_normal(const Axis& g, const Axis& h, const Vector3d& origin, const Vector3d& x_before) {
  const Vector3d cross = g.direction.cross(h.direction);
  const Vector3d between = h.point - g.point;
  if (cross.norm() < 1e-9) {
    // parallel: any normal will do; the one through the present origin makes d zero
    const Vector3d foot = h.point + (origin - h.point).dot(h.direction) * h.direction;
    const Vector3d way = foot - origin;
    return {way.norm() > 1e-12 ? way.normalized() : x_before, foot};
  }
  // the foot on h is nearest to g: solve for the parameter along h
  const double c = g.direction.dot(h.direction);
  const double t = (c * between.dot(g.direction) - between.dot(h.direction)) / (1 - c * c);
  Vector3d direction = cross.normalized();
  if (direction.dot(between) < 0) {
    direction = -direction;
  }
  return {direction, h.point + t * h.direction};
}

double angle_about(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  return std::atan2(from.cross(to).dot(axis), from.dot(to));
}

Isometry3d frame(const Vector3d& origin, const Vector3d& x, const Vector3d& z) {
  Isometry3d X = Isometry3d::Identity();
  X.linear().col(0) = x;
  X.linear().col(1) = z.cross(x);
  X.linear().col(2) = z;
  X.translation() = origin;
  return X;
}

}  // namespace

Isometry3d Dh::transform(double angle) const {
  Isometry3d X = Isometry3d::Identity();
  X.rotate(Eigen::AngleAxisd(theta0 + angle, Vector3d::UnitZ()));
  X.translate(Vector3d(a, 0, d));
  X.rotate(Eigen::AngleAxisd(alpha, Vector3d::UnitX()));
  return X;
}

DhChain denavit_hartenberg(const std::vector<Axis>& axes, const Isometry3d& end) {
  assert(!axes.empty());
  DhChain chain;
  Vector3d origin = axes.front().point;
  Vector3d x = across(axes.front().direction);
  if (axes.size() > 1) {
    // start where the first common normal does, so that the first row needs neither theta0 nor d
    const Normal normal = common_normal(axes[0], axes[1], origin, x);
    x = normal.direction;
    origin = axes[0].point + (normal.foot - axes[0].point).dot(axes[0].direction) * axes[0].direction;
  }
  chain.base = frame(origin, x, axes.front().direction);
  for (std::size_t i = 0; i + 1 < axes.size(); ++i) {
    const Vector3d& z = axes[i].direction;
    const Normal normal = common_normal(axes[i], axes[i + 1], origin, x);
    const Vector3d way = normal.foot - origin;
    chain.rows.push_back({angle_about(z, x, normal.direction), way.dot(z), way.dot(normal.direction),
                          angle_about(normal.direction, z, axes[i + 1].direction)});
    origin = normal.foot;
    x = normal.direction;
  }
  chain.rows.push_back({});
  chain.tool = frame(origin, x, axes.back().direction).inverse() * end;
  return chain;
}

}  // namespace figure
