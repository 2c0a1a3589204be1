#pragma once

#include <cstdint>
#include <vector>

#include "manipulators/eye_control/vec2.h"

namespace eye {

/// What is remembered of one internal step: values at its start, and means over the step that follows.
struct Moment {
  Vec2 command;          ///< premotor pursuit velocity c, rad/s
  Vec2 velocity;         ///< pursuit velocity of the eye v, rad/s
  Vec2 copy;             ///< the brain's copy of that velocity w, rad/s
  Vec2 position;         ///< eye in head (Helmholtz version), rad
  Vec2 head;             ///< sum of the eye turns that would have cancelled every head turn, rad
  Vec2 reflex;           ///< mean eye velocity by reflexes over the following step, rad/s
  double disparity = 0;  ///< mean vergence of the seen target over the following step, rad
  double vergence = 0;   ///< vergence of the eyes, rad
  double lid = 0;        ///< lid closure, 0 open to 1 closed
  double swept = 0;      ///< steps since the head carried gaze beyond the eyes' range, counted down to 0
};

/// The last moments, addressed by absolute step number. Holds at least `span + 2` of them.
class Memory {
 public:
  explicit Memory(int span) {
    size_t size = 2;
    while (size < static_cast<size_t>(span) + 2) size *= 2;
    moments_.resize(size);
  }

  Moment& operator[](int64_t step) { return moments_[static_cast<size_t>(step) & (moments_.size() - 1)]; }
  const Moment& operator[](int64_t step) const { return moments_[static_cast<size_t>(step) & (moments_.size() - 1)]; }

  void fill(const Moment& moment) { moments_.assign(moments_.size(), moment); }
  size_t size() const { return moments_.size(); }

 private:
  std::vector<Moment> moments_;
};

}  // namespace eye
