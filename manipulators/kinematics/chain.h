#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "manipulators/kinematics/pose.h"

namespace kinematics {

enum class JointKind { turn, slide };

/// One freedom of a chain. The frame after joint i, seen from the frame before it, is
///   Rz(offset + q) * T(p) * Rx(alpha)     for a turn,
///   Rz(offset) * T(p + q z) * Rx(alpha)   for a slide.
/// With p = (a, 0, d) and offset = theta0 this is the standard Denavit-Hartenberg step (Paul 1981). The free p keeps
/// parallel and nearly parallel axes exact, where Denavit and Hartenberg's d runs to infinity.
struct Joint {
  std::string name;
  JointKind kind = JointKind::turn;
  double offset = 0;                            ///< [rad]
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< [m], in the frame after the turn
  double alpha = 0;                             ///< [rad]
  double lower = 0, upper = 0;                  ///< limits of q [rad or m]
  double rest = 0;                              ///< the posture that null space returns to
};

/// A serial chain: X_base, then the joints, then X_tool. Immutable by habit: build it with ChainBuilder.
struct Chain {
  std::string name;
  Pose base;
  std::vector<Joint> joints;
  Pose tool;

  int size() const { return static_cast<int>(joints.size()); }
  Eigen::VectorXd lower() const;
  Eigen::VectorXd upper() const;
  Eigen::VectorXd rest() const;
};

/// Puts a chain together from fixed transforms and axes anywhere in space; brings it to the normal form of Joint.
class ChainBuilder {
 public:
  explicit ChainBuilder(std::string name) { chain_.name = std::move(name); }

  /// A constant transform after what has been added so far.
  ChainBuilder& fix(const Pose& X);
  /// A turn about, or a slide along, the unit `axis` through the present origin; the frame then goes on unturned at q =
  /// 0.
  ChainBuilder& joint(std::string name, JointKind kind, const Eigen::Vector3d& axis, double lower, double upper,
                      double rest);
  /// One row of a Denavit-Hartenberg table [rad, m].
  ChainBuilder& dh(std::string name, double theta0, double d, double a, double alpha, double lower, double upper,
                   double rest);
  Chain finish();

 private:
  Pose absorb_turn(const Pose& X);

  Chain chain_;
  Pose pending_;        // constant transform since the last joint
  double carried_ = 0;  // turn about z that the next joint's offset takes over
};

/// Pose of the tool in the base's surroundings for joint values q (#joints).
Pose forward(const Chain& chain, std::span<const double> q);

/// Pose of every joint's own frame (its z is the axis, before the turn), then the tool: #joints + 1 poses.
std::vector<Pose> frames(const Chain& chain, std::span<const double> q);

/// The geometric Jacobian, 6 by #joints: rows 0-2 velocity of the tool's origin [m per unit of q], rows 3-5 angular
/// velocity [rad], both in the frame in which `base` is given.
Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Chain& chain, std::span<const double> q);

/// An upper bound of the distance [m] from the first joint to the tool's origin: the sum of links and slides.
double reach_bound(const Chain& chain);

/// The same chain for a body `factor` times as tall: lengths scale, angles stay.
Chain scaled(const Chain& chain, double factor);

/// The chain mirrored in the plane x = 0 (right arm to left arm). A turn keeps its value, a slide changes
/// its sign.
Chain mirrored(const Chain& chain);

}  // namespace kinematics
