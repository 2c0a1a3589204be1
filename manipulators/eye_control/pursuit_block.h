#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "manipulators/eye_control/lag.h"
#include "manipulators/eye_control/parameters.h"

namespace eye {

/// Many pursuit loops at once, for crowds: each lane is one component of one pair of eyes, its own loop with the scalar
/// saturations of one axis, always switched on, without predictor. Structure of arrays: every remembered moment holds
/// all lanes side by side, so that a step is plain loops over lanes that the compiler turns into vector instructions; a
/// lane's bits do not depend on the width of the registers. With a one-dimensional target a lane is `Pursuit` with the
/// switch and the predictor off, to rounding.
class PursuitBlock {
 public:
  static constexpr int lanes = 16;
  using Lanes = std::array<double, lanes>;

  explicit PursuitBlock(const Parameters& p);

  /// One step; `target`: mean target velocity of each lane over the step as it was one visual delay ago, rad/s.
  void advance(const double* target);

  /// Eye velocity and position of each lane, rad/s and rad.
  const Lanes& velocity() const { return past_[static_cast<size_t>(n_) & mask_].velocity; }
  const Lanes& position() const { return position_; }

 private:
  struct alignas(64) Moment {
    Lanes command{}, velocity{}, copy{};
  };
  /// the moments that one step needs, and where it writes
  struct View {
    const Moment *now, *seen0, *seen1, *copied0, *copied1, *local0, *local1, *motor0, *motor1, *copy_motor0,
        *copy_motor1;
    Moment* next;
  };
  struct Constants {
    double step, pursuit_gain, copy_gain, local_gain, acceleration_limit, velocity_limit;
    Lag plant, copy_plant;
  };

  static void step(const Constants& c, const View& m, const double* target, double* position);

  Constants constants_;
  std::array<int, 5> delays_;  ///< visual, copy visual, local, motor, copy motor; steps
  std::vector<Moment> past_;
  size_t mask_ = 0;
  Lanes position_{};
  int64_t n_ = 0;
};

}  // namespace eye
