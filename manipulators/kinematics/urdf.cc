#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "manipulators/kinematics/chain_file.h"
#include "manipulators/kinematics/table.h"

namespace kinematics {

using objdb::ErrorKind;
using objdb::Result;

namespace {

constexpr double endless_limit = 4 * std::numbers::pi;
// metres and radians beyond this are a mistake, and their squares no numbers
constexpr double largest = 1e9;

Pose pose_of(const urdf::Pose& in) {
  const urdf::Rotation& r = in.rotation;
  return {rotation_from_quaternion({r.w, r.x, r.y, r.z}), {in.position.x, in.position.y, in.position.z}};
}

std::vector<urdf::LinkConstSharedPtr> to_root(urdf::LinkConstSharedPtr link) {
  std::vector<urdf::LinkConstSharedPtr> path;
  for (; link; link = link->getParent()) path.push_back(link);
  return path;
}

struct Limits {
  double lower, upper;
};

Limits limits_of(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::CONTINUOUS || !joint.limits) return {-endless_limit, endless_limit};
  return {joint.limits->lower, joint.limits->upper};
}

// adds one joint, walked from parent to child, or backwards: then the axis turns the other way
std::string add(ChainBuilder& builder, const urdf::Joint& joint, bool forwards) {
  const Pose X = pose_of(joint.parent_to_joint_origin_transform);
  if (!(X.p.cwiseAbs().maxCoeff() <= largest)) return "stands farther than 1e9 m from its parent";
  if (joint.type == urdf::Joint::FIXED) {
    builder.fix(forwards ? X : inverse(X));
    return {};
  }
  const bool turns = joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
  if (!turns && joint.type != urdf::Joint::PRISMATIC)
    return "is floating or planar, expected revolute, continuous, prismatic or fixed";
  if (joint.mimic) return "mimics \"" + joint.mimic->joint_name + "\", expected a freedom of its own";
  const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
  const auto [lower, upper] = limits_of(joint);
  if (!(axis.norm() > 0) || !axis.allFinite()) return "has no axis";
  if (!(lower <= upper) || !std::isfinite(lower) || !std::isfinite(upper))
    return "has its lower limit above its upper limit";
  if (std::max(-lower, upper) > largest) return "has a limit beyond 1e9";
  const double rest = lower <= 0 && upper >= 0 ? 0 : 0.5 * (lower + upper);
  const JointKind kind = turns ? JointKind::turn : JointKind::slide;
  if (forwards) {
    builder.fix(X).joint(joint.name, kind, axis, lower, upper, rest);
  } else {
    builder.joint(joint.name, kind, -axis, lower, upper, rest).fix(inverse(X));
  }
  return {};
}

std::string link_names(const urdf::ModelInterface& model) {
  std::string names;
  for (const auto& [name, link] : model.links_) names += (names.empty() ? "" : " ") + name;
  return names;
}

}  // namespace

Result<Chain> read_urdf_chain(const std::string& file, const std::string& base, const std::string& tip) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in) text << in.rdbuf();
  if (!in || in.bad()) return refusal(file, 0, 0, ErrorKind::io, "cannot be read");
  // one clear error of ours instead of the parser's own lines
  console_bridge::noOutputHandler();
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text.str());
  } catch (const std::exception& fault) {
    return refusal(file, 0, 0, ErrorKind::syntax, std::string("is not a URDF: ") + fault.what());
  }
  if (!model) return refusal(file, 0, 0, ErrorKind::syntax, "is not a URDF");
  for (const std::string& name : {base, tip}) {
    if (!model->getLink(name)) {
      return refusal(file, 0, 0, ErrorKind::unknown,
                     "link \"" + name + "\" is not there, expected one of: " + link_names(*model));
    }
  }
  // cut the two ways to the root at their meeting point
  std::vector<urdf::LinkConstSharedPtr> up = to_root(model->getLink(base)), down = to_root(model->getLink(tip));
  while (up.size() > 1 && down.size() > 1 && up[up.size() - 2] == down[down.size() - 2]) {
    up.pop_back();
    down.pop_back();
  }
  ChainBuilder builder(file);
  const auto place = [&](const urdf::Joint& joint, const std::string& fault) {
    return refusal(file, 0, 0, ErrorKind::type, "joint \"" + joint.name + "\" " + fault);
  };
  for (std::size_t i = 0; i + 1 < up.size(); ++i) {
    const std::string fault = add(builder, *up[i]->parent_joint, false);
    if (!fault.empty()) return place(*up[i]->parent_joint, fault);
  }
  for (std::size_t i = down.size() - 1; i-- > 0;) {
    const std::string fault = add(builder, *down[i]->parent_joint, true);
    if (!fault.empty()) return place(*down[i]->parent_joint, fault);
  }
  Chain chain = builder.finish();
  if (chain.size() == 0) {
    return refusal(file, 0, 0, ErrorKind::range, "no joint moves between \"" + base + "\" and \"" + tip + "\"");
  }
  if (chain.size() > max_joints)
    return refusal(file, 0, 0, ErrorKind::limit, "more than " + std::to_string(max_joints) + " joints");
  return chain;
}

}  // namespace kinematics
