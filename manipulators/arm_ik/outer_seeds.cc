#include "manipulators/arm_ik/outer_seeds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "manipulators/arm_ik/random.h"
#include "manipulators/arm_ik/tool_pose.h"

namespace arm_ik {

namespace {

constexpr std::uint64_t seed = 3;
// the better of so many descents is kept
constexpr int tries = 2;
// targets stand this share of the reach beyond the posture that they are made from
constexpr double nearest_share = 0.25, farthest_share = 2;
constexpr int slot_mask = OuterSeeds::count - 1;

void draw(const Packed& chain, Random& random, double* q) {
  for (int i = 0; i < chain.n; ++i) q[i] = random.between(chain.draw_lower[i], chain.draw_upper[i]);
}

kinematics::Pose pose_of(const double* frame) {
  kinematics::Pose X;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) X.R(row, column) = frame[4 * column + row];
    X.p[row] = frame[12 + row];
  }
  return X;
}

}  // namespace

OuterSeeds::OuterSeeds(const Packed& chain) : n_(chain.n), length2_(static_cast<float>(chain.length * chain.length)) {
  Random random(seed);
  DescentOptions how;
  how.standstill = 1e-3;
  how.far = true;
  how.position_tolerance = how.rotation_tolerance = 0;
  const Eigen::Vector3d base(chain.base[12], chain.base[13], chain.base[14]);
  double q[Packed::capacity], best[Packed::capacity], frame[16];
  for (int k = 0; k < count; ++k) {
    draw(chain, random, q);
    tool_pose(chain, q, frame);
    kinematics::Pose target = pose_of(frame);
    const Eigen::Vector3d out = target.p - base;
    target.p += out / std::max(out.norm(), 1e-9) * chain.reach * random.between(nearest_share, farthest_share);
    const Goal goal(target, true);
    double least = HUGE_VAL;
    for (int attempt = 0; attempt < tries; ++attempt) {
      if (attempt > 0) draw(chain, random, q);
      const double cost = descend(chain, goal, how, q, best_isa()).cost;
      if (!(cost < least)) continue;
      least = cost;
      std::copy_n(q, n_, best);
    }
    postures_.insert(postures_.end(), best, best + n_);
    tool_pose(chain, best, frame);
    const kinematics::Pose at = pose_of(frame);
    const Eigen::Vector4d wxyz = kinematics::quaternion(at.R);
    for (int i = 0; i < 3; ++i) place_[i].push_back(static_cast<float>(at.p[i]));
    for (int i = 0; i < 4; ++i) turn_[i].push_back(static_cast<float>(wxyz[i]));
  }
}

void OuterSeeds::nearest(const Goal& goal, int size, int* index) const {
  float p[3], t[4];
  const Eigen::Vector4d wxyz = kinematics::quaternion(goal.target().R);
  for (int i = 0; i < 3; ++i) p[i] = static_cast<float>(goal.frame[12 + i]);
  for (int i = 0; i < 4; ++i) t[i] = static_cast<float>(wxyz[i]);
  const float weight = goal.pose ? 4 * length2_ : 0;
  // the bits of a score, which order like the score itself, the lowest replaced by the number
  std::int32_t key[count];
  for (int k = 0; k < count; ++k) {
    const float dx = place_[0][k] - p[0], dy = place_[1][k] - p[1], dz = place_[2][k] - p[2];
    const float dot = turn_[0][k] * t[0] + turn_[1][k] * t[1] + turn_[2][k] * t[2] + turn_[3][k] * t[3];
    const float miss = std::max(0.0F, 1 - dot * dot);
    key[k] = (std::bit_cast<std::int32_t>(dx * dx + dy * dy + dz * dz + weight * miss) & ~slot_mask) | k;
  }
  for (int rank = 0; rank < size; ++rank) {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (std::int32_t one : key) least = std::min(least, one);
    index[rank] = least & slot_mask;
    key[index[rank]] = std::numeric_limits<std::int32_t>::max();
  }
}

void OuterSeeds::posture(int index, double* q) const {
  std::copy_n(postures_.begin() + static_cast<std::ptrdiff_t>(index) * n_, n_, q);
}

}  // namespace arm_ik
