#include "manipulators/arm_ik/problems.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "manipulators/arm_ik/random.h"

namespace arm_ik {

namespace {

using kinematics::Chain;
using kinematics::Joint;
using kinematics::Pose;

constexpr double degree = std::numbers::pi / 180;
constexpr double course_share = 0.95;

double within(const Joint& joint, Random& random) { return random.between(joint.lower, joint.upper); }

void make_singular(const Chain& chain, Random& random, std::vector<double>& q) {
  if (chain.size() == 11) {
    const int kind = static_cast<int>(random.next() % 3);
    if (kind != 0) q[9] = chain.joints[9].lower;
    if (kind != 1) q[7] = 0;
    return;
  }
  for (int i = 0; i < chain.size(); ++i) {
    if (random.next() & 1) q[i] = std::clamp(0.0, chain.joints[i].lower, chain.joints[i].upper);
  }
}

}  // namespace

std::string_view name_of(ProblemSet set) {
  constexpr std::array<std::string_view, 5> names = {"random", "warm", "near_limit", "singular", "unreachable"};
  return names[static_cast<std::size_t>(set)];
}

std::vector<Problem> problems(const Chain& chain, ProblemSet set, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Problem> out;
  out.reserve(count);
  for (int k = 0; k < count; ++k) {
    std::vector<double> q, start;
    for (const Joint& joint : chain.joints) q.push_back(within(joint, random));
    for (const Joint& joint : chain.joints) start.push_back(within(joint, random));
    if (set == ProblemSet::warm) {
      for (int i = 0; i < chain.size(); ++i) {
        start[i] = std::clamp(q[i] + random.between(-0.1, 0.1), chain.joints[i].lower, chain.joints[i].upper);
      }
    }
    if (set == ProblemSet::near_limit) {
      for (int i = 0; i < chain.size(); ++i) {
        const std::uint64_t kind = random.next() % 4;
        if (kind == 0) q[i] = chain.joints[i].lower;
        if (kind == 1) q[i] = chain.joints[i].upper;
      }
    }
    if (set == ProblemSet::singular) make_singular(chain, random, q);
    Pose target = kinematics::forward(chain, q);
    if (set == ProblemSet::unreachable) {
      const Eigen::Vector3d away = (target.p - chain.base.p).normalized();
      target.p += away * kinematics::reach_bound(chain) * random.between(0.5, 2);
    }
    out.push_back({target, std::move(start)});
  }
  return out;
}

Course::Course(const Chain& chain, int ticks, std::uint64_t seed) : ticks_(ticks) {
  Random random(seed);
  for (const Joint& joint : chain.joints) {
    Wave wave{};
    wave.middle = 0.5 * (joint.lower + joint.upper);
    wave.half = 0.5 * (joint.upper - joint.lower) * course_share;
    wave.share = random.between(0.5, 1);
    wave.phase = random.between(0, 2 * std::numbers::pi);
    wave.second_phase = random.between(0, 2 * std::numbers::pi);
    wave.harmonic = 1 + static_cast<int>(random.next() % 2);
    wave.second_harmonic = 1 + static_cast<int>(random.next() % 3);
    waves_.push_back(wave);
  }
}

std::vector<double> Course::posture(int tick) const {
  const double time = 2 * std::numbers::pi * (tick % ticks_) / ticks_;
  std::vector<double> q;
  for (const Wave& w : waves_) {
    q.push_back(w.middle + w.half * (w.share * std::sin(w.harmonic * time + w.phase) +
                                     (1 - w.share) * std::sin(w.second_harmonic * time + w.second_phase)));
  }
  return q;
}

double Course::largest_step() const {
  double largest = 0;
  for (int t = 0; t < ticks_; ++t) {
    const std::vector<double> a = posture(t), b = posture(t + 1);
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(b[i] - a[i]));
  }
  return largest;
}

Chain iiwa14() {
  kinematics::ChainBuilder builder("iiwa14");
  constexpr double d[7] = {0.36, 0, 0.42, 0, 0.4, 0, 0.126}, alpha[7] = {-90, 90, 90, -90, -90, 90, 0};
  constexpr double limit[7] = {170, 120, 170, 120, 170, 120, 175};
  for (int i = 0; i < 7; ++i) {
    builder.dh("a" + std::to_string(i + 1), 0, d[i], 0, alpha[i] * degree, -limit[i] * degree, limit[i] * degree, 0);
  }
  return builder.finish();
}

Chain panda() {
  kinematics::ChainBuilder builder("panda");
  constexpr double a[7] = {0, 0, 0, 0.0825, -0.0825, 0, 0.088}, d[7] = {0.333, 0, 0.316, 0, 0.384, 0, 0};
  constexpr double alpha[7] = {0, -90, 90, 90, -90, 90, 90};
  constexpr double lower[7] = {-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973};
  constexpr double upper[7] = {2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973};
  for (int i = 0; i < 7; ++i) {
    builder.fix({Eigen::Matrix3d::Identity(), {a[i], 0, 0}})
        .fix({kinematics::rotation_x(alpha[i] * degree), {0, 0, 0}});
    builder.fix({Eigen::Matrix3d::Identity(), {0, 0, d[i]}});
    builder.joint("joint" + std::to_string(i + 1), kinematics::JointKind::turn, Eigen::Vector3d::UnitZ(), lower[i],
                  upper[i], 0.5 * (lower[i] + upper[i]));
  }
  builder.fix({Eigen::Matrix3d::Identity(), {0, 0, 0.107}});
  return builder.finish();
}

}  // namespace arm_ik
