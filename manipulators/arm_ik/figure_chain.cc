#include "manipulators/arm_ik/figure_chain.h"

#include <algorithm>

#include "manipulators/kinematics/chain_file.h"

namespace arm_ik {

namespace {

using kinematics::JointKind;
using kinematics::Pose;
using objdb::Object;
using objdb::scene::Scene;
using objdb::scene::Transform;

Pose pose_of(const Transform& x) {
  Pose out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.R(row, column) = x.R[row][column];
    out.p[row] = x.p[row];
  }
  return out;
}

template <class T>
const T& value(const Object& object, int field) {
  return std::get<T>(object.value(field));
}

// from just below the root down to the tip; empty when the root does not carry the tip
std::vector<const Object*> way_down(objdb::Database& world, const Object* root, const Object& tip) {
  std::vector<const Object*> way;
  const Object* at = &tip;
  for (; at != nullptr && at != root; at = world.object(world.scene().parent_of(*at))) way.push_back(at);
  if (at != root) way.clear();
  std::reverse(way.begin(), way.end());
  return way;
}

bool is_joint(objdb::Database& world, const Object& object) { return object.type->is(world.scene().joint_type()); }

}  // namespace

std::variant<FigureChain, std::string> find_chain(objdb::Database& world, const Object* root, const Object& tip) {
  const std::vector<const Object*> way = way_down(world, root, tip);
  if (way.empty()) return tip.path + " does not stand below " + root->path;
  FigureChain out;
  kinematics::ChainBuilder builder(tip.path);
  for (const Object* each : way) {
    builder.fix(pose_of(objdb::scene::from_pose(value<objdb::Vec3>(*each, Scene::position),
                                                value<objdb::Quat>(*each, Scene::orientation))));
    if (!is_joint(world, *each)) continue;
    const double lower = value<double>(*each, Scene::lower), upper = value<double>(*each, Scene::upper);
    if (lower > upper) return "joint " + each->path + " has its lower limit above its upper limit";
    const auto& dh = value<objdb::Numbers>(*each, Scene::dh);
    const double rest = std::clamp(value<double>(*each, Scene::rest), lower, upper);
    builder.dh(std::string(each->name()), dh[0], dh[1], dh[2], dh[3], lower, upper, rest);
    out.joints.push_back(each->id);
  }
  if (out.joints.empty()) return "no joint between " + (root ? root->path : "the world") + " and " + tip.path;
  if (static_cast<int>(out.joints.size()) > kinematics::max_joints) {
    return std::to_string(out.joints.size()) + " joints above " + tip.path + ", expected at most " +
           std::to_string(kinematics::max_joints);
  }
  out.chain = builder.finish();
  return out;
}

std::vector<double> fingerprint(objdb::Database& world, const Object* root, const Object& tip) {
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

}  // namespace arm_ik
