#include "manipulators/arm_ik/human_arm.h"

#include <algorithm>
#include <cmath>

namespace arm_ik {

namespace {

using kinematics::Chain;
using kinematics::Pose;
using kinematics::Side;

// angles of a figure have as many digits as it was written with
constexpr double angle_tolerance = 1e-5;
// every link may have its own length: people's arms are not scaled copies of each other
constexpr double length_tolerance = 1e-4, least_factor = 0.4, most_factor = 2.5;

bool same_angle(double a, double b) { return std::abs(std::remainder(a - b, 2 * M_PI)) < angle_tolerance; }

// b times some sensible factor
bool same_direction(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  if (b.norm() < length_tolerance) return a.norm() < 2 * length_tolerance;
  const double factor = a.dot(b) / b.squaredNorm();
  return factor > least_factor && factor < most_factor && (a - factor * b).norm() < length_tolerance;
}

// the same axes in the same order; the tool and the base are free
bool same_shape(const Chain& chain, const Chain& model) {
  if (chain.size() != model.size()) return false;
  for (int i = 0; i < model.size(); ++i) {
    const kinematics::Joint &a = chain.joints[i], &b = model.joints[i];
    if (a.kind != b.kind) return false;
    // what follows the last turn belongs to the tool
    if (i + 1 == model.size()) break;
    if (!same_angle(a.offset, b.offset) || !same_angle(a.alpha, b.alpha) || !same_direction(a.p, b.p)) return false;
  }
  return true;
}

}  // namespace

std::optional<HumanArm> HumanArm::recognize(const Chain& chain) {
  const Chain model = kinematics::arm11();
  HumanArm out;
  if (same_shape(chain, model)) {
    out.chain_ = chain;
  } else if (const Chain image = kinematics::mirrored(chain); same_shape(image, model)) {
    out.chain_ = image;
    out.side_ = Side::left;
  } else {
    return {};
  }
  out.thorax_ = out.chain_.base.R * model.base.R.transpose();
  const std::vector<double> zero(joints, 0.0);
  const std::vector<Pose> X = kinematics::frames(out.chain_, zero);
  out.humerus_offset_ = X[9].R.transpose() * out.thorax_;
  out.forearm_offset_ = X[11].R.transpose() * out.thorax_;
  return out;
}

Pose HumanArm::mirrored(const Pose& X) const {
  if (side_ == Side::right) return X;
  const Eigen::DiagonalMatrix<double, 3> M(-1, 1, 1);
  return {M * X.R * M, M * X.p};
}

GirdleAngles HumanArm::girdle_of(double plane, double elevation) const {
  GirdleAngles out = rhythm(plane, elevation);
  for (int i = 0; i < girdle; ++i) out[i] = std::clamp(out[i], chain_.joints[i].lower, chain_.joints[i].upper);
  return out;
}

Eigen::Matrix3d HumanArm::humerus(std::span<const double> q) const {
  return thorax_.transpose() * kinematics::frames(chain_, q)[9].R * humerus_offset_;
}

std::array<double, 2> HumanArm::direction(const Eigen::Matrix3d& H, double fallback) {
  const double sine = std::hypot(H(0, 1), H(2, 1));
  // below this the plane is rounding noise
  const double plane = sine > 1e-9 ? std::atan2(H(2, 1), -H(0, 1)) : fallback;
  return {plane, std::atan2(sine, H(1, 1))};
}

IsbAngles HumanArm::isb(std::span<const double> q) const {
  // thorax x right, y up, z back becomes x forward, y up, z right
  const Eigen::Matrix3d P = (Eigen::Matrix3d() << 0, 0, -1, 0, 1, 0, 1, 0, 0).finished();
  const Eigen::Matrix3d upper = humerus(q);
  const std::vector<Pose> X = kinematics::frames(chain_, q);
  const Eigen::Matrix3d fore = thorax_.transpose() * X[11].R * forearm_offset_;
  const Eigen::Matrix3d H = P * upper * P.transpose();
  const Eigen::Matrix3d E = P * upper.transpose() * fore * P.transpose();
  IsbAngles out;
  // H = Ry(plane) Rx(elevation) Ry(axial), elevation <= 0; axial from the remainder, so that zero elevation is harmless
  const double sine = -std::hypot(H(0, 1), H(2, 1));
  out.plane = sine < -1e-9 ? std::atan2(-H(0, 1), -H(2, 1)) : 0;
  out.elevation = std::atan2(sine, H(1, 1));
  const Eigen::Matrix3d rest = kinematics::rotation_x(-out.elevation) * kinematics::rotation_y(-out.plane) * H;
  out.axial = std::atan2(rest(0, 2), rest(0, 0));
  // E = Rz(flexion) Rx(carrying) Ry(pronation)
  out.carrying = std::asin(std::clamp(E(2, 1), -1.0, 1.0));
  out.flexion = std::atan2(-E(0, 1), E(1, 1));
  out.pronation = std::atan2(-E(2, 0), E(2, 2));
  return out;
}

}  // namespace arm_ik
