#include "manipulators/arm_ik/tracker.h"

#include <algorithm>
#include <cmath>

#include "manipulators/arm_ik/bounded_step.h"

namespace arm_ik {

namespace {

using kernel::Frame;
using kernel::Held;
using kernel::Residual;
using kernel::State;
using kernel::StepBox;
using kernel::System;

constexpr int corrections = 6;
// the pull leaves this part of the rate to the task and its correction
constexpr double pull_share = 0.9;
// squared length of chain.length that regularizes the task: far below any tolerance
constexpr double damping = 1e-8;
// the descent that takes over when the task cannot be done
constexpr int nearest_steps = 10;
constexpr double nearest_damping = 0.5;

struct Followed {
  double position2 = 0, rotation2 = 0;
  int iterations = 0;
  bool reached = false;
};

/// What a tick may do, in arrays padded to fours.
struct Tick {
  alignas(64) double low[Packed::capacity], high[Packed::capacity], posture[Packed::capacity];
  double rate = 0, gain = 0;
  double position2 = 0, rotation2 = 0;  // squared tolerances
};

template <bool pose, bool slides>
ARM_IK_INLINE Followed follow_body(const Packed& chain, const Goal& goal, const Tick& tick, double* q) {
  State state;
  System system;
  Held held;
  StepBox box;
  alignas(64) double dq[Packed::capacity];
  for (int i = 0; i < 4 * chain.blocks; ++i) state.q[i] = i < chain.n ? q[i] : 0;
  for (int i = chain.n; i < 4 * chain.blocks; ++i) system.Jv[i] = system.Jw[i] = Real4{};
  const Frame wanted = {load<4>(goal.frame), load<4>(goal.frame + 4), load<4>(goal.frame + 8),
                        load<4>(goal.frame + 12)};
  const double length = chain.length;
  const Real4 pull_cap = fill<4>(pull_share * tick.rate), one = fill<4>(1.0);
  kernel::forward<slides>(chain, state);
  Residual e = kernel::residual<pose>(state.end, wanted, length);
  Followed out;
  while (out.iterations < corrections) {
    const bool pulling = out.iterations++ == 0;
    kernel::linearize<slides>(chain, state, length, system);
    for (int block = 0; block < chain.blocks; ++block) {
      const int i = 4 * block;
      const Real4 at = load<4>(state.q + i), lower = load<4>(chain.lower + i), upper = load<4>(chain.upper + i);
      Real4 low = load<4>(tick.low + i) - at, high = load<4>(tick.high + i) - at, bias = one - one;
      const Real4 half = 0.5 * (upper - lower);
      if (pulling) {
        low = low < -pull_cap ? -pull_cap : low;
        high = high > pull_cap ? pull_cap : high;
        bias = tick.gain * (load<4>(tick.posture + i) - at);
        bias = bias > pull_cap ? pull_cap : bias < -pull_cap ? -pull_cap : bias;
      }
      // willing in the middle of its range, unwilling at its ends
      const Real4 from_middle = (at - 0.5 * (upper + lower)) / (half > 0 ? half : one);
      const Real4 willing = 1.0001 - from_middle * from_middle;
      store<4>(box.low + i, low);
      store<4>(box.high + i, high);
      store<4>(box.bias + i, bias);
      store<4>(box.weight + i, willing * willing);
    }
    kernel::bounded_step<pose, true>(chain, system, e, box, damping * length * length, held, dq);
    Real4 moved = one - one;
    for (int block = 0; block < chain.blocks; ++block) {
      const int i = 4 * block;
      const Real4 at = load<4>(state.q + i), low = load<4>(tick.low + i), high = load<4>(tick.high + i);
      Real4 next = at + load<4>(dq + i);
      next = next > low ? next : low;
      next = next < high ? next : high;
      moved += (next - at) * (next - at);
      store<4>(state.q + i, next);
    }
    kernel::forward<slides>(chain, state);
    e = kernel::residual<pose>(state.end, wanted, length);
    out.reached = e.position2 <= tick.position2 && (!pose || e.rotation2 <= tick.rotation2);
    // a tenth of the tolerance, so that the next tick starts clean
    if (e.position2 <= 0.01 * tick.position2 && (!pose || e.rotation2 <= 0.01 * tick.rotation2)) break;
    if ((moved[0] + moved[1]) + (moved[2] + moved[3]) < 1e-16) break;
  }
  out.position2 = e.position2;
  out.rotation2 = e.rotation2;
  std::copy_n(state.q, chain.n, q);
  return out;
}

ARM_IK_INLINE Followed choose(const Packed& chain, const Goal& goal, const Tick& tick, double* q) {
  if (chain.slides)
    return goal.pose ? follow_body<true, true>(chain, goal, tick, q) : follow_body<false, true>(chain, goal, tick, q);
  return goal.pose ? follow_body<true, false>(chain, goal, tick, q) : follow_body<false, false>(chain, goal, tick, q);
}

Followed follow_portable(const Packed& chain, const Goal& goal, const Tick& tick, double* q) {
  return choose(chain, goal, tick, q);
}

[[gnu::target("avx2")]] Followed follow_avx2(const Packed& chain, const Goal& goal, const Tick& tick, double* q) {
  return choose(chain, goal, tick, q);
}

}  // namespace

Solution Tracker::follow(const Goal& goal, const TrackOptions& options, std::span<const double> posture, double dt,
                         std::span<double> q) const {
  Tick tick;
  tick.rate = options.rate * dt;
  tick.gain = 1 - std::exp(-dt / options.settle);
  tick.position2 = options.position_tolerance * options.position_tolerance;
  // the solvers measure a turn by its chord
  const double chord = 2 * std::sin(0.5 * std::min(options.rotation_tolerance, 3.1));
  tick.rotation2 = chord * chord;
  double start[Packed::capacity];
  for (int i = 0; i < 4 * chain_.blocks; ++i) {
    const bool there = i < chain_.n;
    if (there) start[i] = q[i] = std::clamp(q[i], chain_.lower[i], chain_.upper[i]);
    tick.low[i] = there ? std::max(chain_.lower[i], q[i] - tick.rate) : 0;
    tick.high[i] = there ? std::min(chain_.upper[i], q[i] + tick.rate) : 0;
    tick.posture[i] = there ? posture[i] : 0;
  }
  const Followed step = options.isa == Isa::portable ? follow_portable(chain_, goal, tick, q.data())
                                                     : follow_avx2(chain_, goal, tick, q.data());
  Solution out;
  out.method = Method::full;
  out.starts = 1;
  out.iterations = step.iterations;
  if (step.reached) {
    out.status = Status::reached;
    out.position_error = std::sqrt(step.position2);
    out.rotation_error = angle_of_chord(std::sqrt(step.rotation2));
    return out;
  }
  std::copy_n(start, chain_.n, q.begin());
  DescentOptions nearest;
  nearest.position_tolerance = options.position_tolerance;
  nearest.rotation_tolerance = options.rotation_tolerance;
  nearest.iterations = nearest_steps;
  nearest.damping = nearest_damping;
  nearest.far = true;
  nearest.lower = tick.low;
  nearest.upper = tick.high;
  const DescentResult found = descend(chain_, goal, nearest, q.data(), options.isa);
  out.iterations += found.iterations;
  out.position_error = found.position_error;
  out.rotation_error = found.rotation_error;
  out.status = found.reached ? Status::reached : Status::limited;
  return out;
}

}  // namespace arm_ik
