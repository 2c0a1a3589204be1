#pragma once

#include <cstdint>
#include <vector>

#include "manipulators/eye_control/lanes.h"

namespace eye {

/// What is remembered of one internal step: values at its start, and means over the step that follows.
template <int W>
struct Moment {
  Pairs<W> command;         ///< premotor pursuit velocity c, rad/s
  Pairs<W> velocity;        ///< pursuit velocity of the eye v, rad/s
  Pairs<W> copy;            ///< the brain's copy of that velocity w, rad/s
  Pairs<W> position;        ///< eye in head (Helmholtz version), rad
  Pairs<W> head;            ///< sum of the eye turns that would have cancelled every head turn, rad
  Pairs<W> reflex;          ///< mean eye velocity by reflexes over the following step, rad/s
  Lanes<W> disparity = {};  ///< mean vergence of the seen target over the following step, rad
  Lanes<W> vergence = {};   ///< vergence of the eyes, rad
  Lanes<W> lid = {};        ///< lid closure, 0 open to 1 closed
  Lanes<W> swept = {};      ///< steps since the head carried gaze beyond the eyes' range, counted down to 0
};

/// The last moments, addressed by absolute step number. Holds at least `span + 2` of them.
template <int W>
class Memory {
 public:
  explicit Memory(int span) {
    size_t size = 2;
    while (size < static_cast<size_t>(span) + 2) size *= 2;
    moments_.resize(size);
  }

  Moment<W>& operator[](int64_t step) { return moments_[static_cast<size_t>(step) & (moments_.size() - 1)]; }
  const Moment<W>& operator[](int64_t step) const {
    return moments_[static_cast<size_t>(step) & (moments_.size() - 1)];
  }

  size_t size() const { return moments_.size(); }

 private:
  std::vector<Moment<W>> moments_;
};

}  // namespace eye
