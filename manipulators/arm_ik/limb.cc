#include "manipulators/arm_ik/limb.h"

#include <algorithm>
#include <cmath>

namespace arm_ik {

namespace {

using kinematics::Pose;

constexpr int first = 6, elbow = 9, forearm = 10;

template <int N>
struct Vector {
  typename Lanes<N>::Real x, y, z;
};

template <int N>
ARM_IK_INLINE Vector<N> times(const double* rows, const Vector<N>& v) {
  return {rows[0] * v.x + rows[1] * v.y + rows[2] * v.z, rows[3] * v.x + rows[4] * v.y + rows[5] * v.z,
          rows[6] * v.x + rows[7] * v.y + rows[8] * v.z};
}

template <int N>
ARM_IK_INLINE typename Lanes<N>::Real dot(const Vector<N>& a, const Vector<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <int N>
ARM_IK_INLINE Vector<N> cross(const Vector<N>& a, const Vector<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Sine and cosine of the four joints' own angles (offset included); the shoulder in its first branch.
template <int N>
struct Turns {
  typename Lanes<N>::Real s[4], c[4], outside;
};

template <int N, bool swings>
ARM_IK_INLINE Turns<N> turns_of(const Limb::Constants& k, const Vector<N>& target, typename Lanes<N>::Real swivel_s,
                                typename Lanes<N>::Real swivel_c) {
  using Real = typename Lanes<N>::Real;
  const Real one = fill<N>(1.0);
  const Vector<N> t = {target.x - k.center[0], target.y - k.center[1], target.z - k.center[2]};
  // elbow from the distance
  const Real wanted = (dot<N>(t, t) - k.mean) / k.swing;
  const Real cosine = wanted > one ? one : wanted < -one ? -one : wanted;
  const Real sine = k.branch * square_root<N>((one - cosine) * (one + cosine));
  Turns<N> out;
  out.outside = wanted > one ? wanted - one : wanted < -one ? -one - wanted : one - one;
  out.c[3] = k.phase_c * cosine - k.phase_s * sine;
  out.s[3] = k.phase_s * cosine + k.phase_c * sine;
  // wrist in the humerus frame
  const Real wx = out.c[3] * k.forearm[0] - out.s[3] * k.forearm[1],
             wy = out.s[3] * k.forearm[0] + out.c[3] * k.forearm[1];
  const Vector<N> v = {k.upper_arm[0] + wx, k.upper_arm[1] + (k.elbow_c * wy - k.elbow_s * k.forearm[2]),
                       k.upper_arm[2] + (k.elbow_s * wy + k.elbow_c * k.forearm[2])};
  // least turn that takes the wrist at rest to the direction of the target
  const Vector<N> a = times<N>(k.reference, v);
  const Real length2 = dot<N>(a, a);
  const Real scale = one / square_root<N>(length2 * dot<N>(t, t) + 1e-300);
  const Vector<N> axis = cross<N>(a, t);
  const Vector<N> ks = {axis.x * scale, axis.y * scale, axis.z * scale};
  const Real c = dot<N>(a, t) * scale;
  const Real rest = one / (one + c + 1e-15);
  // unit target direction, for the swivel
  const Real unit = one / square_root<N>(dot<N>(t, t) + 1e-300);
  const Vector<N> u = {t.x * unit, t.y * unit, t.z * unit};
  // columns of the humerus frame in the socket frame
  Vector<N> H[3];
  for (int column = 0; column < 3; ++column) {
    const Vector<N> r = {k.reference[column] + (t.x - t.x), k.reference[3 + column] + (t.x - t.x),
                         k.reference[6 + column] + (t.x - t.x)};
    const Vector<N> kr = cross<N>(ks, r);
    const Real along = dot<N>(ks, r) * rest;
    const Vector<N> turned = {c * r.x + kr.x + ks.x * along, c * r.y + kr.y + ks.y * along,
                              c * r.z + kr.z + ks.z * along};
    Vector<N> swung = turned;
    if constexpr (swings) {
      const Vector<N> ut = cross<N>(u, turned);
      const Real uu = dot<N>(u, turned) * (one - swivel_c);
      swung = {swivel_c * turned.x + swivel_s * ut.x + u.x * uu, swivel_c * turned.y + swivel_s * ut.y + u.y * uu,
               swivel_c * turned.z + swivel_s * ut.z + u.z * uu};
    }
    H[column] = times<N>(k.to_socket, swung);
  }
  // H = Rz(a) M Rz(c), see the header of Limb: sin b < 0 is the branch of a raised arm
  const Real sb = square_root<N>(H[2].x * H[2].x + H[2].y * H[2].y);
  const auto locked = sb < 1e-14;
  const Real inverse = one / (locked ? one : sb);
  out.c[0] = locked ? one : -H[2].x * inverse;
  out.s[0] = locked ? one - one : -H[2].y * inverse;
  out.s[1] = -sb;
  out.c[1] = -H[2].z;
  out.s[2] = out.s[0] * H[0].x - out.c[0] * H[0].y;
  out.c[2] = out.s[0] * H[1].x - out.c[0] * H[1].y;
  return out;
}

template <class Real>
ARM_IK_INLINE Real wrapped(Real angle, double middle) {
  // adding and taking away 1.5 * 2^52 rounds to the nearest integer without a call
  constexpr double turn = 2 * M_PI, rounder = 6755399441055744.0;
  return angle - turn * (((angle - middle) * (1 / turn) + rounder) - rounder);
}

/// Joint values and their largest excess over the limits; a number each, or a vector of eight.
template <class Real>
struct Joints {
  Real q[4], excess;
};

// joint values from raw angles: the turn nearest to the middle of the range
template <class Real>
ARM_IK_INLINE Joints<Real> joints_of(const Limb::Constants& k, const Real* raw) {
  Joints<Real> out;
  out.excess = raw[0] - raw[0];
  for (int i = 0; i < 4; ++i) {
    out.q[i] = wrapped<Real>(raw[i] - k.offset[i], k.middle[i]);
    const Real above = out.q[i] - k.upper[i], below = k.lower[i] - out.q[i];
    out.excess = above > out.excess ? above : out.excess;
    out.excess = below > out.excess ? below : out.excess;
  }
  return out;
}

// the shoulder's other branch, same posture
template <class Real>
ARM_IK_INLINE Joints<Real> other_joints_of(const Limb::Constants& k, const Real* raw) {
  const Real other[4] = {raw[0] + M_PI, -raw[1], raw[2] + M_PI, raw[3]};
  return joints_of(k, other);
}

// rounding at full stretch is not out of reach
ARM_IK_INLINE bool reachable(double outside) { return outside <= 1e-12; }

template <bool swings>
ARM_IK_INLINE Limb::Answer solve_body(const Limb::Constants& k, const Eigen::Vector3d& target, double s, double c) {
  using Real1 = Lanes<1>::Real;
  const Turns<1> turns =
      turns_of<1, swings>(k, {Real1{target.x()}, Real1{target.y()}, Real1{target.z()}}, Real1{s}, Real1{c});
  const Real4 raw = angle_of<4>(Real4{turns.s[0][0], turns.s[1][0], turns.s[2][0], turns.s[3][0]},
                                Real4{turns.c[0][0], turns.c[1][0], turns.c[2][0], turns.c[3][0]});
  double angles[4];
  store<4>(angles, raw);
  Joints<double> joints = joints_of(k, angles);
  if (joints.excess > 0) {
    const Joints<double> other = other_joints_of(k, angles);
    if (other.excess < joints.excess) joints = other;
  }
  return {{joints.q[0], joints.q[1], joints.q[2], joints.q[3]}, joints.excess, reachable(turns.outside[0])};
}

Limb::Answer least_portable(const Limb::Constants& k, const Eigen::Vector3d& t) {
  return solve_body<false>(k, t, 0, 1);
}

[[gnu::target("avx2")]] Limb::Answer least_avx2(const Limb::Constants& k, const Eigen::Vector3d& t) {
  return solve_body<false>(k, t, 0, 1);
}

template <bool swings>
ARM_IK_INLINE void eight_body(const Limb::Constants& k, const double* targets, const double* s, const double* c,
                              Limb::Answer* answers) {
  const Turns<8> turns = turns_of<8, swings>(k, {load<8>(targets), load<8>(targets + 8), load<8>(targets + 16)},
                                             swings ? load<8>(s) : Real8{}, swings ? load<8>(c) : Real8{});
  Real8 raw[4];
  for (int i = 0; i < 4; ++i) raw[i] = angle_of<8>(turns.s[i], turns.c[i]);
  const Joints<Real8> first = joints_of(k, raw), other = other_joints_of(k, raw);
  const Mask8 better = other.excess < first.excess;
  alignas(64) double out[6][8];
  for (int i = 0; i < 4; ++i) store<8>(out[i], better ? other.q[i] : first.q[i]);
  store<8>(out[4], better ? other.excess : first.excess);
  store<8>(out[5], turns.outside);
  for (int lane = 0; lane < 8; ++lane) {
    answers[lane] = {{out[0][lane], out[1][lane], out[2][lane], out[3][lane]}, out[4][lane], reachable(out[5][lane])};
  }
}

void eight_portable(const Limb::Constants& k, const double* t, const double* s, const double* c,
                    Limb::Answer* answers) {
  return s == nullptr ? eight_body<false>(k, t, s, c, answers) : eight_body<true>(k, t, s, c, answers);
}

[[gnu::target("avx2")]] void eight_avx2(const Limb::Constants& k, const double* t, const double* s, const double* c,
                                        Limb::Answer* answers) {
  return s == nullptr ? eight_body<false>(k, t, s, c, answers) : eight_body<true>(k, t, s, c, answers);
}

[[gnu::target("avx512f,avx512dq,avx512vl")]] void eight_avx512(const Limb::Constants& k, const double* t,
                                                               const double* s, const double* c,
                                                               Limb::Answer* answers) {
  return s == nullptr ? eight_body<false>(k, t, s, c, answers) : eight_body<true>(k, t, s, c, answers);
}

void eight(Isa isa, const Limb::Constants& k, const double* t, const double* s, const double* c,
           Limb::Answer* answers) {
  if (isa == Isa::avx512) return eight_avx512(k, t, s, c, answers);
  if (isa == Isa::avx2) return eight_avx2(k, t, s, c, answers);
  eight_portable(k, t, s, c, answers);
}

void put(double* to, const Eigen::Matrix3d& R) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) to[3 * row + column] = R(row, column);
  }
}

}  // namespace

Limb::Limb(const HumanArm& arm, std::span<const double> posture) {
  const kinematics::Chain& chain = arm.chain();
  std::vector<double> at(posture.begin(), posture.begin() + HumanArm::joints);
  for (int i = first; i < forearm; ++i) at[i] = chain.joints[i].rest;
  const std::vector<Pose> X = kinematics::frames(chain, at);
  Constants& k = constants_;
  Eigen::Map<Eigen::Vector3d>(k.center) = X[first + 1].p;
  put(k.to_socket, X[first].R.transpose());
  // the humerus frame: after the third shoulder turn, before its link
  const kinematics::Joint& third = chain.joints[8];
  const Eigen::Matrix3d reference = X[8].R * kinematics::rotation_z(third.offset + third.rest);
  put(k.reference, reference);
  Eigen::Map<Eigen::Vector3d>(k.upper_arm) = third.p;
  k.elbow_c = std::cos(third.alpha);
  k.elbow_s = std::sin(third.alpha);
  // the wrist in the elbow frame, after the elbow's turn
  const kinematics::Joint &hinge = chain.joints[elbow], &turn = chain.joints[forearm];
  const Eigen::Vector3d wrist = hinge.p + kinematics::rotation_x(hinge.alpha) *
                                              kinematics::rotation_z(turn.offset + at[forearm]) *
                                              (turn.p + kinematics::rotation_x(turn.alpha) * chain.tool.p);
  Eigen::Map<Eigen::Vector3d>(k.forearm) = wrist;
  // |upper_arm + Rx Rz(elbow) wrist|^2 = mean + B cos + C sin
  const Eigen::Vector3d u = kinematics::rotation_x(-third.alpha) * third.p;
  const double B = 2 * (u.x() * wrist.x() + u.y() * wrist.y()), C = 2 * (u.y() * wrist.x() - u.x() * wrist.y());
  k.mean = u.squaredNorm() + wrist.squaredNorm() + 2 * u.z() * wrist.z();
  k.swing = std::hypot(B, C);
  k.phase_c = B / k.swing;
  k.phase_s = C / k.swing;
  for (int i = 0; i < 4; ++i) {
    const kinematics::Joint& joint = chain.joints[first + i];
    k.offset[i] = joint.offset;
    k.lower[i] = joint.lower;
    k.upper[i] = joint.upper;
    k.middle[i] = 0.5 * (joint.lower + joint.upper);
  }
  // the elbow bends to one side of full stretch: the one where most of its range lies
  k.branch = std::sin(k.middle[3] + k.offset[3] - std::atan2(C, B)) < 0 ? -1 : 1;
}

Limb::Answer Limb::solve(const Eigen::Vector3d& target, double swivel) const {
  if (swivel != 0) return solve_body<true>(constants_, target, std::sin(swivel), std::cos(swivel));
  static const bool wide = best_isa() != Isa::portable;
  return wide ? least_avx2(constants_, target) : least_portable(constants_, target);
}

void Limb::solve_eight(const double* targets, Answer* answers, Isa isa) const {
  eight(isa, constants_, targets, nullptr, nullptr, answers);
}

Limb::Answer Limb::solve_within_limits(const Eigen::Vector3d& target, int samples) const {
  Answer best = solve(target);
  if (best.excess <= 0) return best;
  double targets[24];
  for (int lane = 0; lane < 8; ++lane) {
    for (int axis = 0; axis < 3; ++axis) targets[8 * axis + lane] = target[axis];
  }
  // in order of swivel, both ways by turns
  for (int batch = 0; batch * 8 < samples - 1; ++batch) {
    double s[8], c[8];
    for (int lane = 0; lane < 8; ++lane) {
      const int number = 8 * batch + lane + 1, side = number & 1 ? 1 : -1;
      const double swivel = side * ((number + 1) / 2) * 2 * M_PI / samples;
      s[lane] = std::sin(swivel);
      c[lane] = std::cos(swivel);
    }
    Answer answers[8];
    eight(best_isa(), constants_, targets, s, c, answers);
    for (const Answer& answer : answers) {
      if (answer.excess <= 0) return answer;
      if (answer.excess < best.excess) best = answer;
    }
  }
  return best;
}

namespace {

constexpr int girdle_passes = 12;
constexpr double girdle_settled = 1e-6;  // [rad]

// forearm turn that brings the tool's orientation nearest to the wanted one, the rest of the arm as it is
double best_forearm(const HumanArm& arm, std::span<const double> q, const Eigen::Matrix3d& wanted) {
  const kinematics::Chain& chain = arm.chain();
  const kinematics::Joint& turn = chain.joints[forearm];
  const Eigen::Matrix3d before = kinematics::frames(chain, q)[forearm].R * kinematics::rotation_z(turn.offset);
  // maximize trace(wanted^T before Rz(q) tool)
  const Eigen::Matrix3d M = kinematics::rotation_x(turn.alpha) * chain.tool.R * wanted.transpose() * before;
  const double best = std::atan2(M(0, 1) - M(1, 0), M(0, 0) + M(1, 1));
  return std::clamp(wrapped(best, 0.5 * (turn.lower + turn.upper)), turn.lower, turn.upper);
}

}  // namespace

Solution solve_limb(const HumanArm& arm, const Goal& goal, const SolveOptions& options, bool rhythm_girdle,
                    std::span<double> q) {
  const kinematics::Chain& chain = arm.chain();
  const Pose wanted = arm.mirrored(goal.target());
  Solution out;
  out.method = Method::limb;
  out.starts = 1;
  if (rhythm_girdle) {
    for (int i = first; i < forearm; ++i) q[i] = chain.joints[i].rest;
  }
  q[forearm] = chain.joints[forearm].rest;
  std::array<double, 2> direction = {0, 0};
  Limb::Answer answer{};
  for (int pass = 0; pass < girdle_passes; ++pass) {
    ++out.iterations;
    double moved = 0;
    if (rhythm_girdle) {
      direction = HumanArm::direction(arm.humerus(q), direction[0]);
      const GirdleAngles girdle = arm.girdle_of(direction[0], direction[1]);
      for (int i = 0; i < HumanArm::girdle; ++i) {
        moved = std::max(moved, std::abs(q[i] - girdle[i]));
        q[i] = girdle[i];
      }
    }
    const double before = q[forearm];
    if (goal.pose && pass > 0) q[forearm] = best_forearm(arm, q, wanted.R);
    moved = std::max(moved, std::abs(q[forearm] - before));
    answer = Limb(arm, q).solve_within_limits(wanted.p);
    for (int i = 0; i < 4; ++i) {
      const kinematics::Joint& joint = chain.joints[first + i];
      q[first + i] = std::clamp(answer.q[i], joint.lower, joint.upper);
    }
    if (pass > 1 && moved < girdle_settled) break;
    if (!rhythm_girdle && !goal.pose) break;
  }
  const Pose at = kinematics::forward(chain, q);
  out.position_error = (wanted.p - at.p).norm();
  out.rotation_error = goal.pose ? kinematics::rotation_distance(wanted.R, at.R) : 0;
  const bool reached =
      out.position_error <= options.position_tolerance && out.rotation_error <= options.rotation_tolerance;
  out.status = reached                                 ? Status::reached
               : answer.excess > 0 || answer.reachable ? Status::limited
                                                       : Status::unreachable;
  return out;
}

}  // namespace arm_ik
