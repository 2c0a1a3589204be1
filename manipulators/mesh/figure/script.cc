#include "manipulators/mesh/figure/script.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace figure {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

std::string rounded(double value, const char* format) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  std::string result = text;
  if (result.find('.') != std::string::npos) {
    result.erase(result.find_last_not_of('0') + 1);
    if (result.back() == '.') {
      result.pop_back();
    }
  }
  return result == "-0" ? "0" : result;
}

std::string words(const Vector3d& p) { return number(p.x()) + " " + number(p.y()) + " " + number(p.z()); }

std::string words(const Isometry3d& X, const std::string& position, const std::string& orientation) {
  std::string text;
  if (!X.translation().isZero(1e-9)) {
    text += " " + position + " " + words(Vector3d(X.translation()));
  }
  Quaterniond q(X.linear());
  if (q.w() < 0) {
    q.coeffs() = -q.coeffs();
  }
  if (q.vec().norm() > 1e-9) {
    // orientations keep ten digits: they add up along a chain
    text += " " + orientation;
    for (double part : {q.w(), q.x(), q.y(), q.z()}) {
      text += " " + rounded(part, "%.10f");
    }
  }
  return text;
}

std::string joint_line(const Part& joint) {
  std::string line = "create joint " + joint.name + " parent " + joint.parent;
  line += words(joint.offset, "position", "orientation");
  line += " dh " + number(joint.dh.theta0) + " " + number(joint.dh.d) + " " + number(joint.dh.a) + " " +
          number(joint.dh.alpha);
  line += " lower " + number(joint.lower) + " upper " + number(joint.upper);
  if (joint.rest != 0) {
    line += " rest " + number(joint.rest);
  }
  if (joint.stand != 0) {
    line += " angle " + number(joint.stand);
  }
  return line;
}

std::string node_line(const Part& node) {
  return "create node " + node.name + (node.parent.empty() ? "" : " parent " + node.parent) +
         words(node.offset, "position", "orientation");
}

bool in_neck(const Part& part) { return part.name.rfind("neck_", 0) == 0 || part.name == "head"; }

std::string rows(const Eigen::MatrixX4d& matrix) {
  std::string text;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (int column = 0; column < 4; ++column) {
      text += " " + number(matrix(i, column));
    }
  }
  return text;
}

std::string garment_line(const Clothing& piece) {
  std::string line = "create garment " + piece.name + " skin body layer " + std::to_string(piece.layer) + " color " +
                     words(piece.color) + " gloss " + number(piece.gloss);
  if (piece.thickness != 0) {
    line += " thickness " + number(piece.thickness);
  }
  if (piece.smoothing != 0) {
    line += " smoothing " + std::to_string(piece.smoothing);
  }
  if (!piece.flare.isZero()) {
    line += " flare" + rows(piece.flare.transpose());
  }
  const auto list = [&](const std::string& field, const std::string& values) {
    line += values.empty() ? "" : " \\\n  " + field + values;
  };
  std::string bones;
  for (const std::string& bone : piece.bones) {
    bones += " bones/" + bone;
  }
  list("bones", bones);
  list("planes", rows(piece.planes));
  list("lines", rows(piece.lines));
  return line;
}

}  // namespace

std::string number(double value) { return rounded(value, "%.9f"); }

std::string skeleton_script(const Skeleton& skeleton, const Landmarks& marks) {
  std::string text =
      "# The sailor's skeleton: Denavit-Hartenberg chains on the pelvis; angles in rad, lengths in metres.\n"
      "# Made by scripts/figures/make from the body's landmarks; docs/figure.md tells from what.\n"
      "# Stature " +
      number(marks.stature) + ", arm segments against the Dutch model: girdle " +
      rounded(skeleton.arm_scale.girdle, "%.3f") + ", humerus " + rounded(skeleton.arm_scale.humerus, "%.3f") +
      ", forearm " + rounded(skeleton.arm_scale.forearm, "%.3f") + ".\n";
  bool neck_sourced = false;
  for (const Part& part : skeleton.parts) {
    if (in_neck(part)) {
      text += neck_sourced ? "" : "source neck.dlg\n";
      neck_sourced = true;
      continue;
    }
    text += (part.is_joint ? joint_line(part) : node_line(part)) + "\n";
  }
  return text;
}

std::string body_script(const Skeleton& skeleton, const Landmarks& marks, const std::string& file) {
  std::string text =
      "# The sailor's body: the skin of Debian's assimp-testmodels, its bones, and the uniform.\n"
      "# Made by scripts/figures/make; the types are declared by render. Needs skeleton.dlg.\n";
  text += "create node bones\n";
  for (const Segment& segment : skeleton.segments) {
    text += "create bone bones/" + segment.name + " parent " + segment.parent + " from " + words(segment.from) +
            " to " + words(segment.to) + " radius " + number(segment.radius) +
            words(segment.bind, "bind_position", "bind_orientation") + "\n";
  }
  // a bone may take its twist from one that comes later
  for (const Segment& segment : skeleton.segments) {
    if (!segment.twist_from.empty()) {
      text += "set bones/" + segment.name + ".twist_from bones/" + segment.twist_from + "\n";
      text += "set bones/" + segment.name + ".twist " + number(segment.twist) + "\n";
    }
  }
  text += "create skin body skeleton bones file " + file + " color 0.80 0.61 0.50\n";
  for (const Clothing& piece : uniform(marks)) {
    text += garment_line(piece) + "\n";
  }
  text += "create mesh cap file cap.obj parent head color 0.96 0.96 0.94\n";
  text += "create mesh right_shoe file right_shoe.obj parent right_foot color 0.10 0.095 0.095\n";
  text += "create mesh left_shoe file left_shoe.obj parent left_foot color 0.10 0.095 0.095\n";
  // the sphere through the eyeball's vertices is a little large for it because of the cornea, and would hide the edges
  // of the lids, which lie 14.4 to 15.5 mm from its centre
  const double radius = 0.962 * marks.eye_radius;
  for (const char* side : {"right", "left"}) {
    text += std::string("create eyeball ") + side + "_eyeball parent " + side + "_eye_socket radius " + number(radius) +
            " iris " + number(0.47 * radius) + " pupil " + number(0.165 * radius) + "\n";
  }
  return text;
}

std::string gaze_script(const Landmarks& marks) {
  const Vector3d eye = marks.eye - marks.skull;
  std::string text =
      "# The sailor's eyes and what moves them and the head. Made by scripts/figures/make; the types are declared by\n"
      "# head_ik and eye_control. Needs skeleton.dlg; body.dlg, when it is there, comes before.\n";
  text += "create neck neck root thorax tip head sight " + words(Vector3d(0, eye.y(), eye.z())) + "\n";
  text += "create eye right_eye parent head position " + words(Vector3d(-eye.x(), eye.y(), eye.z())) + "\n";
  text += "create eye left_eye parent head position " + words(eye) + "\n";
  text += "create gaze gaze left left_eye right right_eye head head neck neck\n";
  return text;
}

}  // namespace figure
