#include "manipulators/eye_control/aim.h"

#include <algorithm>
#include <cmath>

namespace eye {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d fick_direction(Vec2 angles) {
  const double level = std::cos(angles.y);
  return {-std::sin(angles.x) * level, std::sin(angles.y), std::cos(angles.x) * level};
}

Vec2 fick_angles(const Vector3d& direction) {
  return {std::atan2(-direction.x(), direction.z()),
          std::atan2(direction.y(), std::hypot(direction.x(), direction.z()))};
}

Quaterniond fick_rotation(Vec2 angles) {
  return Quaterniond(Eigen::AngleAxisd(-angles.x, Vector3d::UnitY()) * Eigen::AngleAxisd(-angles.y, Vector3d::UnitX()));
}

Vector3d helmholtz_direction(Vec2 angles) {
  const double across = std::cos(angles.x);
  return {-std::sin(angles.x), across * std::sin(angles.y), across * std::cos(angles.y)};
}

Vec2 helmholtz_angles(const Vector3d& direction) {
  return {std::atan2(-direction.x(), std::hypot(direction.y(), direction.z())),
          std::atan2(direction.y(), direction.z())};
}

Sight sight_of_point(const Vector3d& point, const HeadPose& head) {
  const Vector3d inside = head.orientation.conjugate() * (point - head.position);
  const double distance = inside.norm();
  if (!(distance > 1e-6)) return {};
  return {inside / distance, 1 / distance};
}

Sight sight_of_direction(const Vector3d& direction, double nearness, const HeadPose& head) {
  return {head.orientation.conjugate() * direction, nearness};
}

namespace {

// the unit vector at `angle` from straight ahead, on the side of `direction`
Vector3d on_cone(const Vector3d& direction, double angle) {
  const double aside = std::hypot(direction.x(), direction.y());
  const double right = aside > 1e-12 ? direction.x() / aside : -1;
  const double up = aside > 1e-12 ? direction.y() / aside : 0;
  return {right * std::sin(angle), up * std::sin(angle), std::cos(angle)};
}

}  // namespace

Aim aim_at(const Sight& target, double eye_distance, double range) {
  const bool beyond = target.direction.z() < std::cos(range);
  const Vector3d d = beyond ? on_cone(target.direction, range) : target.direction;

  // each eye sees the target from half the distance aside, on the common plane of regard
  const double half = 0.5 * eye_distance * target.nearness;
  const double forward = std::hypot(d.y(), d.z());
  const double elevation = std::atan2(d.y(), d.z());
  if (half == 0) return {{std::atan2(-d.x(), forward), elevation}, 0, beyond};
  const double left = std::atan2(half - d.x(), forward);
  const double right = std::atan2(-half - d.x(), forward);
  return {{0.5 * (left + right), elevation}, left - right, beyond};
}

Vec2 within_range(Vec2 version, double range) {
  // almost always deep inside: no trigonometry needed
  if (dot(version, version) < near_range2(range)) return version;
  const Vector3d d = helmholtz_direction(version);
  return d.z() >= std::cos(range) ? version : helmholtz_angles(on_cone(d, range));
}

double eccentricity(Vec2 version) {
  const Vector3d d = helmholtz_direction(version);
  return std::atan2(std::hypot(d.x(), d.y()), d.z());
}

namespace {

// shortest rotation from one unit vector to another; undefined only for opposite ones, which no eye reaches
Quaterniond shortest(const Vector3d& from, const Vector3d& to) {
  const Vector3d axis = from.cross(to);
  Quaterniond q(1 + from.dot(to), axis.x(), axis.y(), axis.z());
  q.normalize();
  return q;
}

}  // namespace

Quaterniond listing(const Vector3d& direction, double primary_azimuth) {
  if (primary_azimuth == 0) return shortest(Vector3d::UnitZ(), direction);
  // the orientation that looks straight ahead is the reference, whatever the primary direction
  const Vector3d primary = fick_direction({primary_azimuth, 0});
  return shortest(primary, direction) * shortest(primary, Vector3d::UnitZ()).conjugate();
}

double torsion(const Quaterniond& orientation) {
  const double sign = orientation.w() < 0 ? -1 : 1;
  const double half = orientation.vec().norm();
  if (half < 1e-300) return 0;
  return sign * 2 * std::atan2(half, std::abs(orientation.w())) * orientation.z() / half;
}

}  // namespace eye
