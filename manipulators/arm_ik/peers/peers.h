#pragma once

#include "manipulators/arm_ik/cpu_clock.h"
#include "manipulators/arm_ik/peer.h"
#include "manipulators/arm_ik/random.h"

namespace arm_ik {

std::unique_ptr<Peer> kdl_newton(const kinematics::Chain& chain);
std::unique_ptr<Peer> kdl_levenberg(const kinematics::Chain& chain);
std::unique_ptr<Peer> mujoco_loop(const kinematics::Chain& chain);
std::unique_ptr<Peer> dart_solver(const kinematics::Chain& chain);

/// The loop that all peers share: one attempt after the other, the first from q, the rest from random postures.
class RestartingPeer : public Peer {
 public:
  explicit RestartingPeer(const kinematics::Chain& chain) : chain_(chain) {}

  void solve(const kinematics::Pose& target, double position_tolerance, double rotation_tolerance, double budget,
             std::span<double> q) override {
    Random random(1);
    const double end = cpu_seconds() + budget;
    while (true) {
      attempt(target, position_tolerance, rotation_tolerance, end, q);
      if (good(target, position_tolerance, rotation_tolerance, q) || cpu_seconds() >= end) return;
      for (int i = 0; i < chain_.size(); ++i) q[i] = random.between(chain_.joints[i].lower, chain_.joints[i].upper);
    }
  }

 protected:
  virtual void attempt(const kinematics::Pose& target, double position_tolerance, double rotation_tolerance, double end,
                       std::span<double> q) = 0;

  bool good(const kinematics::Pose& target, double position_tolerance, double rotation_tolerance,
            std::span<const double> q) const {
    for (int i = 0; i < chain_.size(); ++i) {
      if (!(q[i] >= chain_.joints[i].lower - 1e-9 && q[i] <= chain_.joints[i].upper + 1e-9)) return false;
    }
    const kinematics::Pose at = kinematics::forward(chain_, q);
    return (at.p - target.p).norm() <= position_tolerance &&
           kinematics::rotation_distance(at.R, target.R) <= rotation_tolerance;
  }

  /// The constant transform behind joint i, its turn left out.
  kinematics::Pose link(int i) const {
    const kinematics::Joint& joint = chain_.joints[i];
    const Eigen::Matrix3d turn = kinematics::rotation_z(joint.offset);
    return {turn * kinematics::rotation_x(joint.alpha), turn * joint.p};
  }

  kinematics::Chain chain_;
};

}  // namespace arm_ik
