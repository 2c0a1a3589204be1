#include "manipulators/head_ik/chain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace head {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using objdb::Object;
using objdb::scene::Scene;
using objdb::scene::Transform;

constexpr double alike = 1e-6;

Matrix3d rotation_of(const Transform& x) {
  Matrix3d R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = x.R[i][j];
  return R;
}

Vector3d vector_of(const objdb::Vec3& p) { return {p[0], p[1], p[2]}; }

template <class T>
const T& value(const Object& object, int field) {
  return std::get<T>(object.value(field));
}

// from just below the root down to the tip; empty when the root is not above the tip
std::vector<const Object*> way_down(objdb::Database& world, const Object& root, const Object& tip) {
  std::vector<const Object*> way;
  const Object* at = &tip;
  for (; at != nullptr && at != &root; at = world.object(world.scene().parent_of(*at))) way.push_back(at);
  if (at == nullptr) way.clear();
  std::reverse(way.begin(), way.end());
  return way;
}

bool is_joint(objdb::Database& world, const Object& object) { return object.type->is(world.scene().joint_type()); }

// where one freedom turns, in the root's frame at zero angles
struct Axis {
  const Object* joint;
  Vector3d way, centre;
};

std::optional<std::string> fault(const std::vector<Axis>& axes) {
  const auto joint = [&](std::size_t j) { return "joint " + axes[j].joint->path; };
  if (axes.empty()) return "there is no joint between root and tip";
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const std::string wanted = "_" + std::string(name_of(static_cast<Freedom>(j % 3)));
    if (!axes[j].joint->path.ends_with(wanted))
      return joint(j) + " should be named ..." + wanted + ": a level is flexion, lateral, axial from below";
    const double lower = value<double>(*axes[j].joint, Scene::lower),
                 upper = value<double>(*axes[j].joint, Scene::upper);
    const double rest = value<double>(*axes[j].joint, Scene::rest);
    if (!(lower <= rest && rest <= upper)) return joint(j) + " has its rest angle outside its limits";
    if ((axes[j].way - axes[j % 3].way).norm() > alike)
      return joint(j) + " is not parallel to the one of the lowest level";
    if ((axes[j].centre - axes[j - j % 3].centre).norm() > alike)
      return joint(j) + " does not meet the other axes of its level in one centre";
  }
  if (axes.size() % 3 != 0) return "the top level has no joint ..._" + std::string(name_of(axial));
  if (axes.size() > 3 * Neck::most_levels)
    return std::to_string(axes.size() / 3) + " levels, expected at most " + std::to_string(Neck::most_levels);
  if ((axes[flexion].way.cross(axes[axial].way) - axes[lateral].way).norm() > alike)
    return "the axes of the lowest level are not at right angles, flexion to the left, axial up, lateral forward";
  return {};
}

}  // namespace

std::variant<Chain, std::string> find_chain(objdb::Database& world, const Object& root, const Object& tip) {
  const std::vector<const Object*> way = way_down(world, root, tip);
  if (way.empty()) return tip.path + " does not stand below " + root.path;

  // the chain at zero angles
  Transform X;
  std::vector<Axis> axes;
  for (const Object* each : way) {
    const Transform placed = objdb::scene::from_pose(value<objdb::Vec3>(*each, Scene::position),
                                                     value<objdb::Quat>(*each, Scene::orientation));
    X = X * placed;
    if (!is_joint(world, *each)) continue;
    axes.push_back({each, rotation_of(X).col(2), vector_of(X.p)});
    const auto& dh = value<objdb::Numbers>(*each, Scene::dh);
    X = X * objdb::scene::denavit_hartenberg(dh[0], dh[1], dh[2], dh[3]);
  }
  if (auto sentence = fault(axes)) return *sentence;

  Matrix3d R_RN;
  for (int k = 0; k < 3; ++k) R_RN.col(axis_of[k]) = axes[k].way;
  std::vector<Level> levels;
  for (std::size_t j = 0; j < axes.size(); j += 3) {
    Level level;
    const std::string_view name = axes[j].joint->name();
    level.name = name.substr(0, name.size() - std::string_view("_flexion").size());
    for (int k = 0; k < 3; ++k) {
      level.lower[k] = value<double>(*axes[j + k].joint, Scene::lower);
      level.upper[k] = value<double>(*axes[j + k].joint, Scene::upper);
      level.rest[k] = value<double>(*axes[j + k].joint, Scene::rest);
    }
    const Vector3d next = j + 3 < axes.size() ? axes[j + 3].centre : vector_of(X.p);
    level.rise = R_RN.transpose() * (next - axes[j].centre);
    levels.push_back(std::move(level));
  }
  Chain chain{Neck(std::move(levels)), {}, R_RN, axes[0].centre, R_RN.transpose() * rotation_of(X)};
  for (const Axis& axis : axes) chain.joints.push_back(axis.joint->id);
  return chain;
}

std::vector<double> fingerprint(objdb::Database& world, const Object& root, const Object& tip) {
  std::vector<double> numbers;
  const auto add = [&](const auto& values) { numbers.insert(numbers.end(), values.begin(), values.end()); };
  for (const Object* each : way_down(world, root, tip)) {
    numbers.push_back(each->id);
    add(value<objdb::Vec3>(*each, Scene::position));
    add(value<objdb::Quat>(*each, Scene::orientation));
    if (!is_joint(world, *each)) continue;
    add(value<objdb::Numbers>(*each, Scene::dh));
    for (const int field : {Scene::lower, Scene::upper, Scene::rest}) numbers.push_back(value<double>(*each, field));
  }
  return numbers;
}

}  // namespace head
