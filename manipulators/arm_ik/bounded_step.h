#pragma once

#include "manipulators/arm_ik/kernel.h"

namespace arm_ik::kernel {

struct Residual {
  Real4 v, w;  // linear, angular times length
  double position2 = 0, rotation2 = 0;
};

template <bool pose>
ARM_IK_INLINE Residual residual(const Frame& at, const Frame& goal, double length) {
  Residual out;
  out.v = goal.p - at.p;
  out.position2 = sum3(out.v * out.v);
  if constexpr (pose) {
    const Real4 turn = turn_error(at, goal);
    out.rotation2 = sum3(turn * turn);
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

/// Joints that a step holds at a bound: +1 upper, -1 lower, 0 free. Kept from step to step.
struct Held {
  alignas(64) double side[Packed::capacity] = {};
};

/// What a step may do: each joint between `low` and `high`; when `pulled`, it would by itself move by `bias`, and
/// resists departures with the inverse of `weight`.
struct StepBox {
  alignas(64) double low[Packed::capacity], high[Packed::capacity];
  alignas(64) double bias[Packed::capacity], weight[Packed::capacity];
};

/// The step of one iteration, min |J dq - e|^2 + damping |dq - bias|^2 (in the norm of 1 / weight) inside the box, by
/// an active set that starts from the one of the step before. As the damping goes to zero this is the step nearest to
/// `bias` that does what the task asks. `system` brings its columns; its blocks are filled here.
template <bool pose, bool pulled>
ARM_IK_INLINE void bounded_step(const Packed& chain, System& system, const Residual& e, const StepBox& box,
                                double damping, Held& held, double* dq) {
  alignas(64) double pull[Packed::capacity];
  Residual rest = e;
  clear(system);
  // what joint i does by itself is taken from the task; its column takes part when it is free
  const auto move = [&](int i, double by) {
    rest.v -= by * system.Jv[i];
    if constexpr (pose) rest.w -= by * system.Jw[i];
  };
  const auto weight = [&](int i) { return pulled ? box.weight[i] : 1.0; };
  const auto bias = [&](int i) { return pulled ? box.bias[i] : 0.0; };
  for (int i = 0; i < chain.n; ++i) {
    if (held.side[i] == 0) {
      add_column<pose>(system, i, weight(i));
      if constexpr (pulled) move(i, bias(i));
    } else {
      move(i, held.side[i] > 0 ? box.high[i] : box.low[i]);
    }
  }
  const int rounds = 4 + 2 * chain.n;
  for (int round = 0; round < rounds; ++round) {
    Real4 yv, yw{};
    solve<pose>(system, damping, rest.v, rest.w, yv, yw);
    pull_back<pose>(chain, system, yv, yw, pull);
    Real4 wrong{};
    for (int block = 0; block < chain.blocks; ++block) {
      const int i = 4 * block;
      const Real4 low = load<4>(box.low + i), high = load<4>(box.high + i), side = load<4>(held.side + i);
      Real4 free_step = load<4>(pull + i);
      if constexpr (pulled) {
        free_step = load<4>(box.bias + i) + load<4>(box.weight + i) * free_step;
        store<4>(pull + i, free_step);
      }
      const Real4 step = side == 0 ? free_step : side > 0 ? high : low;
      store<4>(dq + i, step);
      // free joints must stay inside, held ones must be pushed against their bound
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
        if (dq[i] <= box.high[i] && dq[i] >= box.low[i]) continue;
        held.side[i] = dq[i] > box.high[i] ? 1 : -1;
        dq[i] = held.side[i] > 0 ? box.high[i] : box.low[i];
        add_column<pose>(system, i, -weight(i));
        move(i, dq[i] - bias(i));
        added = true;
      } else if (held.side[i] * (pull[i] - dq[i]) < most) {
        most = held.side[i] * (pull[i] - dq[i]);
        inward = i;
      }
    }
    if (added) continue;
    if (inward < 0) return;
    add_column<pose>(system, inward, weight(inward));
    move(inward, bias(inward) - dq[inward]);
    held.side[inward] = 0;
  }
  // no end in sight: the last step, cut to the box by the caller, is still tried
}

}  // namespace arm_ik::kernel
