#include "manipulators/arm_ik/descent.h"

#include <algorithm>
#include <cmath>

#include "manipulators/arm_ik/kernel.h"
#include "manipulators/arm_ik/tool_pose.h"

namespace arm_ik {

Goal::Goal(const kinematics::Pose& X, bool with_orientation) : pose(with_orientation) {
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) frame[4 * column + row] = X.R(row, column);
    frame[4 * column + 3] = 0;
  }
  for (int row = 0; row < 3; ++row) frame[12 + row] = X.p[row];
  frame[15] = 0;
}

kinematics::Pose Goal::target() const {
  kinematics::Pose X;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) X.R(row, column) = frame[4 * column + row];
    X.p[row] = frame[12 + row];
  }
  return X;
}

namespace {

using kernel::Frame;
using kernel::State;
using kernel::System;

struct Residual {
  Real4 v, w;  // linear, angular times length
  double position2 = 0, rotation2 = 0;
};

template <bool pose>
ARM_IK_INLINE Residual residual(const Frame& at, const Frame& goal, double length) {
  Residual out;
  out.v = goal.p - at.p;
  out.position2 = kernel::sum3(out.v * out.v);
  if constexpr (pose) {
    const Real4 turn = kernel::turn_error(at, goal);
    out.rotation2 = kernel::sum3(turn * turn);
    out.w = turn * length;
  }
  return out;
}

/// J^T y for all joints.
template <bool pose>
ARM_IK_INLINE void pull_back(const Packed& chain, const System& system, Real4 yv, Real4 yw, double* out) {
  for (int block = 0; block < chain.blocks; ++block) {
    const int i = 4 * block;
    Real4 part[4];
    for (int k = 0; k < 4; ++k) {
      part[k] = system.Jv[i + k] * yv;
      if constexpr (pose) part[k] += system.Jw[i + k] * yw;
    }
    // four horizontal sums by transposition
    const Real4 ab_low = __builtin_shuffle(part[0], part[1], Mask4{0, 4, 1, 5});
    const Real4 cd_low = __builtin_shuffle(part[2], part[3], Mask4{0, 4, 1, 5});
    const Real4 ab_high = __builtin_shuffle(part[0], part[1], Mask4{2, 6, 2, 6});
    const Real4 cd_high = __builtin_shuffle(part[2], part[3], Mask4{2, 6, 2, 6});
    const Real4 first = __builtin_shuffle(ab_low, cd_low, Mask4{0, 1, 4, 5});
    const Real4 second = __builtin_shuffle(ab_low, cd_low, Mask4{2, 3, 6, 7});
    const Real4 third = __builtin_shuffle(ab_high, cd_high, Mask4{0, 1, 4, 5});
    store<4>(out + i, (first + second) + third);
  }
}

/// Joints that a step holds at a limit: +1 upper, -1 lower, 0 free.
struct Held {
  alignas(64) double side[Packed::capacity] = {};
  int count = 0;
};

/// The step of one iteration, min |J dq - e|^2 + damping |dq|^2 within the limits, by an active set that starts from
/// the one of the step before. `full` has its columns; its blocks are filled here with those of the free joints.
template <bool pose>
ARM_IK_INLINE void bounded_step(const Packed& chain, const State& state, System& system, const Residual& e,
                                double damping, Held& held, double* dq) {
  alignas(64) double pull[Packed::capacity];
  Residual rest = e;
  kernel::clear(system);
  for (int i = 0; i < chain.n; ++i) {
    if (held.side[i] == 0) {
      kernel::add_column<pose>(system, i, 1);
      continue;
    }
    const double gap = (held.side[i] > 0 ? chain.upper[i] : chain.lower[i]) - state.q[i];
    rest.v -= gap * system.Jv[i];
    if constexpr (pose) rest.w -= gap * system.Jw[i];
  }
  const int rounds = 4 + 2 * chain.n;
  for (int round = 0; round < rounds; ++round) {
    Real4 yv, yw{};
    kernel::solve<pose>(system, damping, rest.v, rest.w, yv, yw);
    pull_back<pose>(chain, system, yv, yw, pull);
    Real4 wrong{};
    for (int block = 0; block < chain.blocks; ++block) {
      const int i = 4 * block;
      const Real4 q = load<4>(state.q + i), low = load<4>(chain.lower + i) - q, high = load<4>(chain.upper + i) - q;
      const Real4 side = load<4>(held.side + i), free_step = load<4>(pull + i);
      const Real4 step = side == 0 ? free_step : side > 0 ? high : low;
      store<4>(dq + i, step);
      // free joints must stay inside, held ones must be pushed against their limit
      const Mask4 bad = ((side == 0) & ((step > high) | (step < low))) | ((side * (free_step - step)) < -1e-9);
      wrong += (Real4)(bad & (Mask4)fill<4>(1.0));
    }
    if (__builtin_expect((wrong[0] + wrong[1]) + (wrong[2] + wrong[3]) == 0, 1)) return;

    // hold all that leave the box; only when none does, let the one go that pulls inwards most
    bool added = false;
    int inward = -1;
    double most = -1e-9;
    for (int i = 0; i < chain.n; ++i) {
      if (held.side[i] == 0) {
        const double next = state.q[i] + dq[i];
        if (next <= chain.upper[i] && next >= chain.lower[i]) continue;
        held.side[i] = next > chain.upper[i] ? 1 : -1;
        dq[i] = (held.side[i] > 0 ? chain.upper[i] : chain.lower[i]) - state.q[i];
        kernel::add_column<pose>(system, i, -1);
        rest.v -= dq[i] * system.Jv[i];
        if constexpr (pose) rest.w -= dq[i] * system.Jw[i];
        added = true;
      } else if (held.side[i] * (pull[i] - dq[i]) < most) {
        most = held.side[i] * (pull[i] - dq[i]);
        inward = i;
      }
    }
    if (added) continue;
    if (inward < 0) return;
    kernel::add_column<pose>(system, inward, 1);
    rest.v += dq[inward] * system.Jv[inward];
    if constexpr (pose) rest.w += dq[inward] * system.Jw[inward];
    held.side[inward] = 0;
  }
  // no end in sight: the last step, cut to the box by the caller, is still tried
}

template <bool pose, bool slides>
ARM_IK_INLINE DescentResult descend_body(const Packed& chain, const Goal& goal, const DescentOptions& options,
                                         double* q) {
  // padding joints have no column, so their steps are zero
  State states[2];
  State *state = &states[0], *trial = &states[1];
  System system;
  Held held;
  alignas(64) double dq[Packed::capacity];
  for (int i = 0; i < 4 * chain.blocks; ++i) state->q[i] = i < chain.n ? q[i] : 0;
  for (int i = chain.n; i < 4 * chain.blocks; ++i) system.Jv[i] = system.Jw[i] = Real4{};
  const Frame wanted = {load<4>(goal.frame), load<4>(goal.frame + 4), load<4>(goal.frame + 8),
                        load<4>(goal.frame + 12)};
  const double length = chain.length, length2 = length * length;
  const double position2 = options.position_tolerance * options.position_tolerance;
  const double chord = options.rotation_tolerance < 3 ? 2 * std::sin(0.5 * options.rotation_tolerance) : 2;
  const double rotation2 = chord * chord;

  kernel::forward<slides>(chain, *state);
  Residual e = residual<pose>(state->end, wanted, length);
  double cost = e.position2 + length2 * e.rotation2;
  double share = options.damping;
  DescentResult out;
  int slow = 0;
  while (true) {
    out.reached = e.position2 <= position2 && (!pose || e.rotation2 <= rotation2);
    if (out.reached || out.stationary || out.iterations >= options.iterations) break;
    ++out.iterations;
    kernel::linearize<slides>(chain, *state, length, system);
    double next_cost = cost;
    for (int attempt = 0; attempt < 6; ++attempt) {
      bounded_step<pose>(chain, *state, system, e, share * cost + 1e-15 * length2, held, dq);
      for (int block = 0; block < chain.blocks; ++block) {
        const Real4 next = load<4>(state->q + 4 * block) + load<4>(dq + 4 * block);
        const Real4 low = load<4>(chain.lower + 4 * block), high = load<4>(chain.upper + 4 * block);
        const Real4 above = next > low ? next : low;
        store<4>(trial->q + 4 * block, above < high ? above : high);
      }
      kernel::forward<slides>(chain, *trial);
      const Residual next = residual<pose>(trial->end, wanted, length);
      next_cost = next.position2 + length2 * next.rotation2;
      if (next_cost < cost) {
        e = next;
        break;
      }
      share = share * 8 + 1e-3;
      ++out.iterations;
    }
    if (!(next_cost < cost)) {
      out.stationary = true;
      continue;
    }
    std::swap(state, trial);
    slow = next_cost > options.patience * cost ? slow + 1 : 0;
    out.stationary = slow >= 3 || next_cost > (1 - 1e-9) * cost;
    share = share * 0.3;
    cost = next_cost;
  }
  std::copy_n(state->q, chain.n, q);
  out.cost = cost;
  out.position_error = std::sqrt(e.position2);
  const double half_chord = 0.5 * std::sqrt(e.rotation2);
  out.rotation_error = half_chord < 1e-4 ? 2 * half_chord : 2 * std::asin(std::min(1.0, half_chord));
  return out;
}

ARM_IK_INLINE DescentResult choose(const Packed& chain, const Goal& goal, const DescentOptions& options, double* q) {
  if (chain.slides) {
    return goal.pose ? descend_body<true, true>(chain, goal, options, q)
                     : descend_body<false, true>(chain, goal, options, q);
  }
  return goal.pose ? descend_body<true, false>(chain, goal, options, q)
                   : descend_body<false, false>(chain, goal, options, q);
}

DescentResult descend_portable(const Packed& chain, const Goal& goal, const DescentOptions& options, double* q) {
  return choose(chain, goal, options, q);
}

[[gnu::target("avx2")]] DescentResult descend_avx2(const Packed& chain, const Goal& goal, const DescentOptions& options,
                                                   double* q) {
  return choose(chain, goal, options, q);
}

}  // namespace

void tool_pose(const Packed& chain, const double* q, double* frame) {
  State state;
  for (int i = 0; i < 4 * chain.blocks; ++i) state.q[i] = i < chain.n ? q[i] : 0;
  kernel::forward<true>(chain, state);
  store<4>(frame, state.end.x);
  store<4>(frame + 4, state.end.y);
  store<4>(frame + 8, state.end.z);
  store<4>(frame + 12, state.end.p);
}

DescentResult descend(const Packed& chain, const Goal& goal, const DescentOptions& options, double* q, Isa isa) {
  // four lanes are all that one problem fills
  return isa == Isa::portable ? descend_portable(chain, goal, options, q) : descend_avx2(chain, goal, options, q);
}

}  // namespace arm_ik
