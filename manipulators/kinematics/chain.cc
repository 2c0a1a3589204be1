#include "manipulators/kinematics/chain.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

namespace kinematics {

namespace {

Eigen::VectorXd collect(const Chain& chain, double Joint::*member) {
  Eigen::VectorXd out(chain.size());
  for (int i = 0; i < chain.size(); ++i) out[i] = chain.joints[i].*member;
  return out;
}

// R = Rz(phi) Rx(alpha) Rz(psi) with |phi| <= pi/2, so that a pure Rx(alpha) comes back as it is
struct TurnTiltTurn {
  double phi, alpha, psi;
};

TurnTiltTurn split(const Eigen::Matrix3d& R) {
  const double side = R(1, 2) <= 0 ? 1 : -1;
  const double sine = side * std::hypot(R(0, 2), R(1, 2));
  TurnTiltTurn out{};
  out.phi = sine == 0 ? 0 : std::atan2(side * R(0, 2), -side * R(1, 2));
  out.alpha = std::atan2(sine, R(2, 2));
  // the remainder, not a second independent atan2: exact also where alpha is 0 or pi
  const double c = std::cos(out.phi), s = std::sin(out.phi);
  out.psi = std::atan2(-(c * R(0, 1) + s * R(1, 1)), c * R(0, 0) + s * R(1, 0));
  return out;
}

Pose before_axis(const Joint& joint, double q) {
  const bool turns = joint.kind == JointKind::turn;
  Pose X;
  X.R = rotation_z(joint.offset + (turns ? q : 0));
  X.p = X.R * (turns ? joint.p : Eigen::Vector3d(joint.p + q * Eigen::Vector3d::UnitZ()));
  X.R *= rotation_x(joint.alpha);
  return X;
}

// a frame whose z is the given unit axis, the identity for z itself
Eigen::Matrix3d frame_along(const Eigen::Vector3d& axis) {
  Eigen::Index smallest;
  axis.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix3d R;
  if (axis == Eigen::Vector3d::UnitZ()) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d other = Eigen::Vector3d::Unit(smallest);
  R.col(2) = axis;
  R.col(0) = (other - other.dot(axis) * axis).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

}  // namespace

Eigen::VectorXd Chain::lower() const { return collect(*this, &Joint::lower); }
Eigen::VectorXd Chain::upper() const { return collect(*this, &Joint::upper); }
Eigen::VectorXd Chain::rest() const { return collect(*this, &Joint::rest); }

ChainBuilder& ChainBuilder::fix(const Pose& X) {
  pending_ = pending_ * X;
  return *this;
}

// gives the transform since the last joint to that joint (or to the base), but for a turn about the new z
Pose ChainBuilder::absorb_turn(const Pose& X) {
  if (chain_.joints.empty()) {
    chain_.base = X;
    return {};
  }
  Joint& last = chain_.joints.back();
  const TurnTiltTurn turns = split(X.R);
  last.offset += turns.phi;
  last.p = rotation_z(-turns.phi) * X.p;
  last.alpha = turns.alpha;
  carried_ = turns.psi;
  return {};
}

ChainBuilder& ChainBuilder::joint(std::string name, JointKind kind, const Eigen::Vector3d& axis, double lower,
                                  double upper, double rest) {
  const Eigen::Matrix3d along = frame_along(axis.normalized());
  pending_ = absorb_turn(pending_ * Pose{along, Eigen::Vector3d::Zero()});
  Joint joint;
  joint.name = std::move(name);
  joint.kind = kind;
  joint.offset = carried_;
  joint.lower = lower;
  joint.upper = upper;
  joint.rest = rest;
  chain_.joints.push_back(std::move(joint));
  carried_ = 0;
  pending_ = Pose{along.transpose(), Eigen::Vector3d::Zero()};
  return *this;
}

ChainBuilder& ChainBuilder::dh(std::string name, double theta0, double d, double a, double alpha, double lower,
                               double upper, double rest) {
  joint(std::move(name), JointKind::turn, Eigen::Vector3d::UnitZ(), lower, upper, rest);
  chain_.joints.back().offset += theta0;
  return fix({rotation_x(alpha), {a, 0, d}});
}

Chain ChainBuilder::finish() {
  if (chain_.joints.empty()) {
    chain_.base = pending_;
  } else {
    chain_.tool = pending_;
  }
  return std::move(chain_);
}

std::vector<Pose> frames(const Chain& chain, std::span<const double> q) {
  assert(static_cast<int>(q.size()) >= chain.size());
  std::vector<Pose> out;
  out.reserve(chain.size() + 1);
  Pose X = chain.base;
  for (int i = 0; i < chain.size(); ++i) {
    out.push_back(X);
    X = X * before_axis(chain.joints[i], q[i]);
  }
  out.push_back(X * chain.tool);
  return out;
}

Pose forward(const Chain& chain, std::span<const double> q) {
  Pose X = chain.base;
  for (int i = 0; i < chain.size(); ++i) X = X * before_axis(chain.joints[i], q[i]);
  return X * chain.tool;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Chain& chain, std::span<const double> q) {
  const std::vector<Pose> X = frames(chain, q);
  Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, chain.size());
  for (int i = 0; i < chain.size(); ++i) {
    const Eigen::Vector3d axis = X[i].R.col(2);
    if (chain.joints[i].kind == JointKind::turn) {
      J.col(i) << axis.cross(X.back().p - X[i].p), axis;
    } else {
      J.col(i) << axis, Eigen::Vector3d::Zero();
    }
  }
  return J;
}

double reach_bound(const Chain& chain) {
  double sum = chain.tool.p.norm();
  for (const Joint& joint : chain.joints) {
    if (joint.kind == JointKind::slide) sum += std::max(std::abs(joint.lower), std::abs(joint.upper));
    sum += joint.p.norm();
  }
  return sum;
}

Chain scaled(const Chain& chain, double factor) {
  Chain out = chain;
  out.base.p *= factor;
  out.tool.p *= factor;
  for (Joint& joint : out.joints) {
    joint.p *= factor;
    if (joint.kind == JointKind::turn) continue;
    joint.lower *= factor;
    joint.upper *= factor;
    joint.rest *= factor;
  }
  return out;
}

Chain mirrored(const Chain& chain) {
  // with D = diag(1,1,-1) in every joint frame: D Rz(q) D = Rz(q), D Rx(alpha) D = Rx(-alpha)
  const Eigen::DiagonalMatrix<double, 3> M(-1, 1, 1), D(1, 1, -1);
  Chain out = chain;
  out.base = {M * chain.base.R * D, M * chain.base.p};
  out.tool = {D * chain.tool.R * M, D * chain.tool.p};
  for (Joint& joint : out.joints) {
    joint.p.z() = -joint.p.z();
    joint.alpha = -joint.alpha;
    if (joint.kind == JointKind::turn) continue;
    const double lower = joint.lower;
    joint.lower = -joint.upper;
    joint.upper = -lower;
    joint.rest = -joint.rest;
  }
  return out;
}

}  // namespace kinematics
