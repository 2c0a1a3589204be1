#pragma once

#include <cstdint>
#include <vector>

#include "manipulators/arm_ik/descent.h"

namespace arm_ik {

/// Postures drawn evenly within the limits, sorted by where they put the tool: a table of good starts.
/// Building one forward kinematics each (about 10 ms for 32768), finding is one cell of the table (about 0.2 us).
class SeedBank {
 public:
  static constexpr int default_count = 32768;

  /// `spill` > 0 draws from a box that much larger on either side and clamps: that share / (1 + 2 spill) of the joints
  /// stands at each limit, as the answers of near-limit targets do.
  SeedBank(const Packed& chain, int count, double spill, std::uint64_t seed);

  /// The seeds near a goal in order of their distance from it, place and orientation: those of the goal's cell, and
  /// when some of these have been asked for, those of the cells around it too.
  class Search {
   public:
    Search(const SeedBank& bank, const Goal& goal);
    /// The next nearest seed, -1 when there are no more.
    int next();

   private:
    static constexpr int slot_bits = 11, most = 1 << slot_bits;
    void take(int cell);
    void widen();

    const SeedBank& bank_;
    int cell_, asked_ = 0, count_ = 0;
    float goal_[7], weight_;  // place, quaternion; what orientation weighs
    // the bits of a score, which order like the score itself, the lowest replaced by the slot
    alignas(64) std::int32_t key_[most];
    int seed_[most];
  };

  /// Copies posture number `index` (#joints).
  void posture(int index, double* q) const;
  int size() const { return static_cast<int>(px_.size()); }

 private:
  friend class Search;
  int cell_of(double x, double y, double z) const;

  int n_ = 0;
  double length2_ = 0;
  double low_[3], cell_size_ = 1;
  int cells_[3];
  std::vector<int> begin_;           // first seed of a cell; one more at the end
  std::vector<int> nearest_filled_;  // cell to look in, itself unless it is empty
  std::vector<float> px_, py_, pz_;  // tool position
  std::vector<float> qw_, qx_, qy_, qz_;
  std::vector<float> postures_;  // #seeds by #joints
};

}  // namespace arm_ik
