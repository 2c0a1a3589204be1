#include "manipulators/arm_ik/descent.h"

#include <algorithm>
#include <cmath>

#include "manipulators/arm_ik/bounded_step.h"
#include "manipulators/arm_ik/tool_pose.h"

namespace arm_ik {

Goal::Goal(const kinematics::Pose& X, bool with_orientation) : pose(with_orientation) {
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) frame[4 * column + row] = X.R(row, column);
    frame[4 * column + 3] = 0;
  }
  for (int row = 0; row < 3; ++row) frame[12 + row] = std::clamp(X.p[row], -farthest, farthest);
  frame[15] = 0;
}

double angle_of_chord(double chord) { return chord < 1e-6 ? chord : 2 * std::asin(std::min(1.0, 0.5 * chord)); }

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
using kernel::Held;
using kernel::Residual;
using kernel::State;
using kernel::StepBox;
using kernel::System;

template <bool pose, bool slides>
ARM_IK_INLINE DescentResult descend_body(const Packed& chain, const Goal& goal, const DescentOptions& options,
                                         double* q) {
  // padding joints have no column, so their steps are zero
  State states[2];
  State *state = &states[0], *trial = &states[1];
  System system;
  Held held;
  StepBox box;
  alignas(64) double dq[Packed::capacity];
  for (int i = 0; i < chain.n; ++i) state->q[i] = std::clamp(q[i], chain.lower[i], chain.upper[i]);
  for (int i = chain.n; i < 4 * chain.blocks; ++i) state->q[i] = 0;
  for (int i = chain.n; i < 4 * chain.blocks; ++i) system.Jv[i] = system.Jw[i] = Real4{};
  const Frame wanted = {load<4>(goal.frame), load<4>(goal.frame + 4), load<4>(goal.frame + 8),
                        load<4>(goal.frame + 12)};
  const double length = chain.length, length2 = length * length;
  const double position2 = options.position_tolerance * options.position_tolerance;
  const double chord = options.rotation_tolerance < 3 ? 2 * std::sin(0.5 * options.rotation_tolerance) : 2;
  const double rotation2 = chord * chord;

  const double* lower = options.lower ? options.lower : chain.lower;
  const double* upper = options.upper ? options.upper : chain.upper;
  kernel::forward<slides>(chain, *state);
  Residual e = kernel::residual<pose>(state->end, wanted, length);
  double cost = e.position2 + length2 * e.rotation2;
  double share = options.damping;
  DescentResult out;
  int slow = 0;
  while (true) {
    out.reached = e.position2 <= position2 && (!pose || e.rotation2 <= rotation2);
    if (out.reached || out.stationary || out.iterations >= options.iterations) break;
    ++out.iterations;
    kernel::linearize<slides>(chain, *state, length, system);
    for (int block = 0; block < chain.blocks; ++block) {
      const int i = 4 * block;
      store<4>(box.low + i, load<4>(lower + i) - load<4>(state->q + i));
      store<4>(box.high + i, load<4>(upper + i) - load<4>(state->q + i));
    }
    double next_cost = cost;
    Residual pull = e;
    if (pose && options.far) pull.w *= __builtin_sqrt(std::max(0.0, 1 - 0.25 * e.rotation2));
    for (int attempt = 0; attempt < 6; ++attempt) {
      kernel::bounded_step<pose, false>(chain, system, pull, box, share * cost + 1e-15 * length2, held, dq);
      for (int block = 0; block < chain.blocks; ++block) {
        const Real4 next = load<4>(state->q + 4 * block) + load<4>(dq + 4 * block);
        const Real4 low = load<4>(lower + 4 * block), high = load<4>(upper + 4 * block);
        const Real4 above = next > low ? next : low;
        store<4>(trial->q + 4 * block, above < high ? above : high);
      }
      kernel::forward<slides>(chain, *trial);
      const Residual next = kernel::residual<pose>(trial->end, wanted, length);
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
    out.stationary = slow >= 2 || next_cost > (1 - options.standstill) * cost;
    share = share * 0.3;
    cost = next_cost;
  }
  std::copy_n(state->q, chain.n, q);
  out.cost = cost;
  out.position_error = std::sqrt(e.position2);
  out.rotation_error = angle_of_chord(std::sqrt(e.rotation2));
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
