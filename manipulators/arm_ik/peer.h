#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "manipulators/kinematics/chain.h"

namespace arm_ik {

/// Another library's inverse kinematics, for charts and benchmarks. They live in a shared module of their own
/// (peers/), built when their Debian packages are installed, so that the product never loads them.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;
  /// Starts from q (#joints) and from random postures after that until both tolerances hold or `budget` seconds of
  /// processor time are spent. q: the answer, best or last; the caller judges it by its own forward kinematics.
  virtual void solve(const kinematics::Pose& target, double position_tolerance, double rotation_tolerance,
                     double budget, std::span<double> q) = 0;
};

/// The peers that were built, for one chain; none when the module is not there.
std::vector<std::unique_ptr<Peer>> peers_for(const kinematics::Chain& chain);

/// What the module exports under the name arm_ik_peers.
using PeerTable = std::vector<std::unique_ptr<Peer>> (*)(const kinematics::Chain&);

}  // namespace arm_ik
