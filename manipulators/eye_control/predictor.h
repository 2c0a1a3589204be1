#pragma once

#include <array>

#include "manipulators/eye_control/parameters.h"

namespace eye {

/// Adaptive prediction of one component of target velocity.
///
/// Seen velocity is averaged over boxes (noise would otherwise bias the estimate), an autoregressive model of order two
/// with a constant is fitted to the boxes by recursive least squares with forgetting - a Kalman filter on the
/// parameters - and run forward over the whole latency of pursuit. The forecast is trusted as far as it has lately
/// been better than "it stays as it is": trust 0 leaves pursuit untouched, so what cannot be predicted costs nothing.
class Predictor {
 public:
  /// A forecast of target velocity: value, first and second derivative (rad/s, rad/s^2, rad/s^3).
  struct Forecast {
    double value = 0, rate = 0, curvature = 0;
  };

  explicit Predictor(const Parameters& p);

  /// One internal step of seen velocity, rad/s (its mean over the step). `visible` false: the box is filled with the
  /// forecast itself, nothing is learned, trust fades. `doubt` is how far off the velocity may be, rad/s: it is the
  /// noise of the observation to the filter. True when the step completed a box.
  bool see(double velocity, bool visible, double doubt) {
    doubt_ = doubt > doubt_ ? doubt : doubt_;
    sum_ += velocity;
    count_ += 1;
    seen_ += visible;
    if (count_ < steps_) return false;
    close_box();
    return true;
  }

  /// Trust in the forecast, 0 to 1.
  double trust() const { return trust_; }

  /// The farthest time `ahead` can look, s.
  double horizon() const { return (future_size - 4.5) * period_; }

  /// Forecast of seen velocity `ahead` seconds after the end of the last step seen.
  Forecast ahead(double ahead) const;

  template <class Visit>
  void each(Visit&& visit) {
    visit(sum_), visit(count_), visit(seen_), visit(doubt_), visit(evidence_), visit(moving_), visit(largest_),
        visit(trust_), visit(error_model_), visit(error_hold_);
    for (double& x : box_) visit(x);
    for (double& x : theta_) visit(x);
    for (double& x : P_) visit(x);
    for (double& x : expected_) visit(x);
    for (double& x : future_) visit(x);
  }

 private:
  static constexpr int skill_boxes = 1;   ///< horizon on which the forecast is judged, boxes
  static constexpr int future_size = 13;  ///< boxes -1 ... 11 relative to the last complete one

  void close_box();
  void judge();
  void learn(double usual);
  void look_ahead();

  int steps_;
  double step_, period_, memory_;
  double sum_ = 0, count_ = 0, seen_ = 0, doubt_ = 0, evidence_ = 0, moving_ = 0, largest_ = 0;
  double trust_ = 0, error_model_ = 0, error_hold_ = 0;
  std::array<double, 4> box_{};                     ///< last boxes, newest first
  std::array<double, 3> theta_{};                   ///< x_k = theta . (x_{k-1}, x_{k-2}, scale)
  std::array<double, 9> P_{};                       ///< covariance of theta, row by row
  std::array<double, skill_boxes + 1> expected_{};  ///< what was forecast for the coming boxes
  std::array<double, future_size> future_{};        ///< point values at box centres -1 ... 11
};

}  // namespace eye
