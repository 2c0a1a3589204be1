#pragma once

#include <cstdint>
#include <vector>

#include "manipulators/arm_ik/descent.h"

namespace arm_ik {

/// Postures at the edge of the workspace: the nearest ones to targets drawn out of reach on all sides, at all
/// distances, in all orientations. From the stored answers to the nearest such targets a descent is short and seldom
/// ends in a worse valley. Building one takes about 30 ms, a question 1.5 us.
class OuterSeeds {
 public:
  static constexpr int count = 2048;

  explicit OuterSeeds(const Packed& chain);

  /// The `size` stored postures that miss the goal least, best first.
  void nearest(const Goal& goal, int size, int* index) const;
  /// Copies posture number `index` (#joints).
  void posture(int index, double* q) const;

 private:
  int n_;
  float length2_;
  std::vector<float> place_[3], turn_[4];
  std::vector<double> postures_;  // #seeds by #joints
};

}  // namespace arm_ik
