#include "manipulators/arm_ik/seeds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "manipulators/arm_ik/random.h"
#include "manipulators/arm_ik/tool_pose.h"

namespace arm_ik {

namespace {

// a cell holds this many seeds on average where the tool can be
constexpr int seeds_a_cell = 24;
// the nearest of one cell are tried before the cells around it are looked at
constexpr int widen_after = 4;
// key of a seed that has been given out
constexpr std::int32_t used = std::numeric_limits<std::int32_t>::max();

Eigen::Matrix3d rotation_of(const double* frame) {
  Eigen::Matrix3d R;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) R(row, column) = frame[4 * column + row];
  }
  return R;
}

}  // namespace

SeedBank::SeedBank(const Packed& chain, int count, double spill, std::uint64_t seed)
    : n_(chain.n), length2_(chain.length * chain.length) {
  Random random(seed);
  std::vector<float> postures(static_cast<std::size_t>(count) * n_), position[3], turn[4];
  for (auto& p : position) p.resize(count);
  for (auto& t : turn) t.resize(count);
  double q[Packed::capacity], frame[16];
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < n_; ++i) {
      const double share = random.between(-spill, 1 + spill);
      q[i] = chain.draw_lower[i] + std::clamp(share, 0.0, 1.0) * (chain.draw_upper[i] - chain.draw_lower[i]);
      postures[static_cast<std::size_t>(k) * n_ + i] = static_cast<float>(q[i]);
    }
    tool_pose(chain, q, frame);
    const Eigen::Vector4d wxyz = kinematics::quaternion(rotation_of(frame));
    for (int i = 0; i < 3; ++i) position[i][k] = static_cast<float>(frame[12 + i]);
    for (int i = 0; i < 4; ++i) turn[i][k] = static_cast<float>(wxyz[i]);
  }

  // a grid over the tool's positions, fine enough that a filled cell holds a handful
  double extent[3], volume = 1;
  for (int i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax_element(position[i].begin(), position[i].end());
    low_[i] = *low;
    extent[i] = std::max<double>(*high - *low, 1e-3);
    volume *= extent[i];
  }
  cell_size_ = std::cbrt(volume * seeds_a_cell / count);
  for (int i = 0; i < 3; ++i) cells_[i] = std::clamp(static_cast<int>(extent[i] / cell_size_) + 1, 1, 256);

  std::vector<int> cell(count), order(count);
  const int cell_count = cells_[0] * cells_[1] * cells_[2];
  begin_.assign(cell_count + 1, 0);
  for (int k = 0; k < count; ++k) {
    cell[k] = cell_of(position[0][k], position[1][k], position[2][k]);
    ++begin_[cell[k] + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return cell[a] < cell[b]; });
  for (int k : order) {
    px_.push_back(position[0][k]);
    py_.push_back(position[1][k]);
    pz_.push_back(position[2][k]);
    qw_.push_back(turn[0][k]);
    qx_.push_back(turn[1][k]);
    qy_.push_back(turn[2][k]);
    qz_.push_back(turn[3][k]);
    postures_.insert(postures_.end(), postures.begin() + static_cast<std::ptrdiff_t>(k) * n_,
                     postures.begin() + static_cast<std::ptrdiff_t>(k + 1) * n_);
  }

  // breadth first from all filled cells: an empty one asks the nearest
  nearest_filled_.assign(cell_count, -1);
  std::vector<int> front;
  for (int c = 0; c < cell_count; ++c) {
    if (begin_[c + 1] > begin_[c]) {
      nearest_filled_[c] = c;
      front.push_back(c);
    }
  }
  for (std::size_t head = 0; head < front.size(); ++head) {
    const int c = front[head];
    const int at[3] = {c % cells_[0], c / cells_[0] % cells_[1], c / (cells_[0] * cells_[1])};
    const int stride[3] = {1, cells_[0], cells_[0] * cells_[1]};
    for (int axis = 0; axis < 3; ++axis) {
      for (int step : {-1, 1}) {
        if (at[axis] + step < 0 || at[axis] + step >= cells_[axis]) continue;
        const int neighbour = c + step * stride[axis];
        if (nearest_filled_[neighbour] >= 0) continue;
        nearest_filled_[neighbour] = nearest_filled_[c];
        front.push_back(neighbour);
      }
    }
  }
}

int SeedBank::cell_of(double x, double y, double z) const {
  const double at[3] = {x, y, z};
  int index[3];
  for (int i = 0; i < 3; ++i) {
    index[i] = static_cast<int>(std::clamp((at[i] - low_[i]) / cell_size_, 0.0, cells_[i] - 1.0));
  }
  return index[0] + cells_[0] * (index[1] + cells_[1] * index[2]);
}

SeedBank::Search::Search(const SeedBank& bank, const Goal& goal)
    : bank_(bank), cell_(bank.nearest_filled_[bank.cell_of(goal.frame[12], goal.frame[13], goal.frame[14])]) {
  Eigen::Vector4d wxyz(1, 0, 0, 0);
  if (goal.pose) wxyz = kinematics::quaternion(rotation_of(goal.frame));
  for (int i = 0; i < 3; ++i) goal_[i] = static_cast<float>(goal.frame[12 + i]);
  for (int i = 0; i < 4; ++i) goal_[3 + i] = static_cast<float>(wxyz[i]);
  // squared chord of the turn between the two: 4 (1 - dot^2)
  weight_ = goal.pose ? static_cast<float>(4 * bank.length2_) : 0;
  take(cell_);
}

void SeedBank::Search::take(int cell) {
  const int begin = bank_.begin_[cell], count = std::min(bank_.begin_[cell + 1] - begin, most - count_);
  for (int s = 0; s < count; ++s) {
    const int at = begin + s, slot = count_ + s;
    const float dx = bank_.px_[at] - goal_[0], dy = bank_.py_[at] - goal_[1], dz = bank_.pz_[at] - goal_[2];
    const float dot =
        bank_.qw_[at] * goal_[3] + bank_.qx_[at] * goal_[4] + bank_.qy_[at] * goal_[5] + bank_.qz_[at] * goal_[6];
    const float score = dx * dx + dy * dy + dz * dz + weight_ * std::max(0.0F, 1 - dot * dot);
    key_[slot] = (std::bit_cast<std::int32_t>(score) & ~(most - 1)) | slot;
    seed_[slot] = at;
  }
  count_ += count;
}

void SeedBank::Search::widen() {
  const int* cells = bank_.cells_;
  const int at[3] = {cell_ % cells[0], cell_ / cells[0] % cells[1], cell_ / (cells[0] * cells[1])};
  for (int z = std::max(at[2] - 1, 0); z <= std::min(at[2] + 1, cells[2] - 1); ++z) {
    for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, cells[1] - 1); ++y) {
      for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, cells[0] - 1); ++x) {
        const int cell = x + cells[0] * (y + cells[1] * z);
        if (cell != cell_) take(cell);
      }
    }
  }
}

int SeedBank::Search::next() {
  if (asked_++ == widen_after) widen();
  std::int32_t least = used;
  for (int s = 0; s < count_; ++s) least = std::min(least, key_[s]);
  if (least == used) return -1;
  const int slot = least & (most - 1);
  key_[slot] = used;
  return seed_[slot];
}

void SeedBank::posture(int index, double* q) const {
  for (int i = 0; i < n_; ++i) q[i] = postures_[static_cast<std::size_t>(index) * n_ + i];
}

}  // namespace arm_ik
