#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>

#include "manipulators/arm_ik/peers/peers.h"

namespace arm_ik {

namespace {

KDL::Frame frame_of(const kinematics::Pose& X) {
  const auto& R = X.R;
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          KDL::Vector(X.p.x(), X.p.y(), X.p.z())};
}

class Kdl : public RestartingPeer {
 public:
  explicit Kdl(const kinematics::Chain& chain) : RestartingPeer(chain), lower_(chain.size()), upper_(chain.size()) {
    tree_.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::Fixed), frame_of(chain.base)));
    for (int i = 0; i < chain.size(); ++i) {
      tree_.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), frame_of(link(i))));
      lower_(i) = chain.joints[i].lower;
      upper_(i) = chain.joints[i].upper;
    }
    tree_.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::Fixed), frame_of(chain.tool)));
  }

 protected:
  template <class Solver>
  void run(Solver& solver, const kinematics::Pose& target, std::span<double> q) {
    KDL::JntArray start(static_cast<unsigned>(q.size())), answer(static_cast<unsigned>(q.size()));
    for (unsigned i = 0; i < q.size(); ++i) start(i) = q[i];
    solver.CartToJnt(start, frame_of(target), answer);
    for (unsigned i = 0; i < q.size(); ++i) q[i] = answer(i);
  }

  KDL::Chain tree_;
  KDL::JntArray lower_, upper_;
};

// Newton-Raphson with clamping to the joint limits
class KdlNewton : public Kdl {
 public:
  explicit KdlNewton(const kinematics::Chain& chain) : Kdl(chain), forward_(tree_), velocity_(tree_) {}
  std::string name() const override { return "KDL NR_JL"; }

 protected:
  void attempt(const kinematics::Pose& target, double position_tolerance, double, double,
               std::span<double> q) override {
    KDL::ChainIkSolverPos_NR_JL solver(tree_, lower_, upper_, forward_, velocity_, 100, position_tolerance);
    run(solver, target, q);
  }

 private:
  KDL::ChainFkSolverPos_recursive forward_;
  KDL::ChainIkSolverVel_pinv velocity_;
};

// Levenberg-Marquardt; knows no limits
class KdlLevenberg : public Kdl {
 public:
  using Kdl::Kdl;
  std::string name() const override { return "KDL LMA"; }

 protected:
  void attempt(const kinematics::Pose& target, double position_tolerance, double, double,
               std::span<double> q) override {
    KDL::ChainIkSolverPos_LMA solver(tree_, position_tolerance, 500);
    run(solver, target, q);
    for (int i = 0; i < chain_.size(); ++i) {
      const double middle = 0.5 * (chain_.joints[i].lower + chain_.joints[i].upper);
      q[i] = middle + std::remainder(q[i] - middle, 2 * M_PI);
    }
  }
};

}  // namespace

std::unique_ptr<Peer> kdl_newton(const kinematics::Chain& chain) { return std::make_unique<KdlNewton>(chain); }
std::unique_ptr<Peer> kdl_levenberg(const kinematics::Chain& chain) { return std::make_unique<KdlLevenberg>(chain); }

}  // namespace arm_ik
