#pragma once

#include "manipulators/arm_ik/engine.h"
#include "manipulators/arm_ik/measure.h"

namespace arm_ik {

/// A method of `engine` as a contestant for poses. The engine must outlive it.
Contestant contestant(Engine& engine, Method method);
/// Another library's solver, `budget` seconds a target. The peer must outlive it.
Contestant contestant(Peer& peer, double budget);
/// The tracker with null space pulled to the middle of the ranges, 10 ms ticks. `packed` must outlive it.
Follower follower(const kinematics::Chain& chain, const Packed& packed, double rate);
/// The same with what a limb of a scene has besides: when its way ends it looks for another and travels there.
Follower reacher(const kinematics::Chain& chain, double rate);
/// A peer that is asked anew every tick from its own last answer.
Follower follower(Peer& peer, double budget);

}  // namespace arm_ik
