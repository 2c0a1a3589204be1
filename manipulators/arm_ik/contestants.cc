#include "manipulators/arm_ik/contestants.h"

#include <memory>

#include "manipulators/arm_ik/reacher.h"

namespace arm_ik {

using kinematics::Pose;

namespace {

constexpr double tick = 0.01;  // [s]

}  // namespace

Contestant contestant(Engine& engine, Method method) {
  return {std::string(name_of(method)),
          [&engine, method](const Pose& target, double position, double rotation, std::span<double> q) {
            SolveOptions options;
            options.position_tolerance = position;
            options.rotation_tolerance = rotation;
            (void)engine.solve(method, Goal(target, true), options, q);
          }};
}

Contestant contestant(Peer& peer, double budget) {
  return {peer.name(), [&peer, budget](const Pose& target, double position, double rotation, std::span<double> q) {
            peer.solve(target, position, rotation, budget, q);
          }};
}

Follower follower(const kinematics::Chain& chain, const Packed& packed, double rate) {
  std::vector<double> posture;
  for (const kinematics::Joint& joint : chain.joints) posture.push_back(0.5 * (joint.lower + joint.upper));
  TrackOptions options;
  options.rate = rate;
  return {"tracker", [&packed, posture, options](const Pose& target, std::span<double> q) {
            (void)Tracker(packed).follow(Goal(target, true), options, posture, tick, q);
          }};
}

Follower reacher(const kinematics::Chain& chain, double rate) {
  return {"reacher", [limb = std::make_shared<Reacher>(chain), rate](const Pose& target, std::span<double> q) {
            Reacher::Order order(Goal(target, true));
            order.method = Method::full;
            order.rate = rate;
            (void)limb->tick(order, tick, q);
          }};
}

Follower follower(Peer& peer, double budget) {
  return {peer.name(),
          [&peer, budget](const Pose& target, std::span<double> q) { peer.solve(target, 1e-5, 1e-4, budget, q); }};
}

}  // namespace arm_ik
