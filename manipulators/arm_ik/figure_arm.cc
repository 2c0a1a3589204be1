#include "manipulators/arm_ik/figure_arm.h"

#include <charconv>
#include <cmath>
#include <numbers>

namespace arm_ik {

namespace {

using kinematics::Chain;
using kinematics::Joint;
using kinematics::Pose;
using kinematics::Side;

std::string number(double value) {
  char text[32];
  // -0 would print as such
  return {text, std::to_chars(text, text + sizeof text, value + 0.0).ptr};
}

// exact for whole turns of the table, ten digits of a degree otherwise
std::string degrees(double radians) {
  const double value = radians * 180 / std::numbers::pi;
  return number(std::round(value * 1e9) / 1e9) + "deg";
}

std::string place(const Pose& X) {
  std::string out = " position";
  for (int i = 0; i < 3; ++i) out += " " + number(X.p[i]);
  out += " orientation";
  const Eigen::Vector4d wxyz = kinematics::quaternion(X.R);
  for (int i = 0; i < 4; ++i) out += " " + number(wxyz[i]);
  return out;
}

}  // namespace

std::string figure_script(const FigureArm& figure) {
  const std::string side = figure.side == Side::right ? "right" : "left";
  const std::string prefix = figure.actor + "/" + side + "_";
  const Chain chain = kinematics::scaled(kinematics::arm11(figure.side), figure.stature / kinematics::arm11_stature);
  // the table's frame is the thorax with x right and z back
  Pose base = Pose{kinematics::body_from_thorax(), figure.position} * chain.base;
  std::string parent = figure.actor + "/" + figure.parent, out;
  for (int i = 0; i < chain.size(); ++i) {
    const Joint& joint = chain.joints[i];
    const std::string path = prefix + joint.name;
    out += "create joint " + path + " parent " + parent;
    if (i == 0) out += place(base);
    out += " dh " + degrees(joint.offset) + " " + number(joint.p.z()) + " " + number(joint.p.x()) + " " +
           degrees(joint.alpha);
    out += " lower " + degrees(joint.lower) + " upper " + degrees(joint.upper) + " rest " + degrees(joint.rest) +
           " angle " + degrees(joint.rest) + "\n";
    parent = path;
  }
  out += "create node " + prefix + "hand parent " + parent + place(chain.tool) + "\n";
  out += "create arm " + prefix + "arm root " + figure.actor + "/" + figure.parent + " tip " + prefix + "hand\n";
  return out;
}

}  // namespace arm_ik
