#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/InverseKinematics.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include "manipulators/arm_ik/peers/peers.h"

namespace arm_ik {

namespace {

Eigen::Isometry3d isometry(const kinematics::Pose& X) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = X.R;
  out.translation() = X.p;
  return out;
}

class Dart : public RestartingPeer {
 public:
  explicit Dart(const kinematics::Chain& chain)
      : RestartingPeer(chain), skeleton_(dart::dynamics::Skeleton::create("chain")) {
    dart::dynamics::BodyNode* last = nullptr;
    kinematics::Pose X = chain.base;
    for (int i = 0; i < chain.size(); ++i) {
      dart::dynamics::RevoluteJoint::Properties joint;
      joint.mName = "joint" + std::to_string(i);
      joint.mAxis = Eigen::Vector3d::UnitZ();
      joint.mT_ParentBodyToJoint = isometry(X);
      joint.mPositionLowerLimits[0] = chain.joints[i].lower;
      joint.mPositionUpperLimits[0] = chain.joints[i].upper;
      dart::dynamics::BodyNode::Properties body;
      body.mName = "body" + std::to_string(i);
      last = skeleton_->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(last, joint, body).second;
      X = link(i);
    }
    // cppcheck-suppress nullPointer ; a chain has at least one joint
    tool_ = last->createEndEffector("tool");
    tool_->setDefaultRelativeTransform(isometry(X * chain.tool), true);
    ik_ = tool_->getIK(true);
    ik_->useWholeBody();
  }
  std::string name() const override { return "DART"; }

 protected:
  void attempt(const kinematics::Pose& target, double position_tolerance, double, double,
               std::span<double> q) override {
    skeleton_->setPositions(Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size())));
    ik_->getTarget()->setTransform(isometry(target));
    ik_->getSolver()->setTolerance(position_tolerance);
    ik_->getSolver()->setNumMaxIterations(100);
    ik_->solveAndApply(true);
    const Eigen::VectorXd answer = skeleton_->getPositions();
    std::copy(answer.data(), answer.data() + answer.size(), q.begin());
  }

 private:
  dart::dynamics::SkeletonPtr skeleton_;
  dart::dynamics::EndEffector* tool_ = nullptr;
  dart::dynamics::InverseKinematicsPtr ik_;
};

}  // namespace

std::unique_ptr<Peer> dart_solver(const kinematics::Chain& chain) { return std::make_unique<Dart>(chain); }

}  // namespace arm_ik
