#include "manipulators/eye_control/predictor.h"

#include <algorithm>
#include <cmath>

namespace eye {

namespace {

constexpr double constant = 3 * deg;    // regressor of the constant term: the size of ordinary velocities, rad/s
constexpr double first_variance = 1e4;  // of the parameters before anything was seen
constexpr double certain = 1 * deg;     // doubt that counts as much as what is always unknown, rad/s
constexpr double surprise = 5;          // errors so many times the usual ones are a turn of the motion,
constexpr double sudden = 3 * deg;      // if they are larger than this, rad/s
constexpr double quiet = 0.5 * deg;     // speeds below this teach nothing, rad/s
constexpr double floor = 0.1 * deg;     // errors below this are not worth predicting, rad/s
constexpr double judgement = 0.35;      // weight of the newest box in the running errors
constexpr double change = 0.3 * deg;    // between boxes that counts as evidence, rad/s
constexpr double least_evidence = 5, most_evidence = 8;
constexpr double forgetting = 0.98;  // of the largest speed seen, each box
constexpr double fading = 0.9;       // of trust, each box not seen

}  // namespace

Predictor::Predictor(const Parameters& p)
    : steps_(p.steps(p.predictor_period)), step_(p.step), period_(steps_ * step_), memory_(p.predictor_memory) {
  theta_ = {1, 0, 0};
  for (int i = 0; i < 3; ++i) P_[4 * i] = first_variance;
}

void Predictor::close_box() {
  // a box hidden for more than half of its time is continued by the model itself
  const bool visible = 2 * seen_ > count_;
  const double x = visible ? sum_ / count_ : expected_[0];
  box_ = {x, box_[0], box_[1], box_[2]};
  sum_ = count_ = seen_ = 0;

  if (visible) {
    const double usual = error_model_;
    judge();
    learn(usual);
  } else {
    trust_ *= fading;
  }
  doubt_ = 0;
  look_ahead();
}

void Predictor::judge() {
  const double model = box_[0] - expected_[skill_boxes];
  const double hold = box_[0] - box_[skill_boxes];
  error_model_ += judgement * (model * model - error_model_);
  error_hold_ += judgement * (hold * hold - error_hold_);
  const double skill = 1 - (error_model_ + floor * floor) / (error_hold_ + floor * floor);
  // a model of three parameters fits any three boxes: it counts once it has met more change than that. A ramp is no
  // evidence, and neither is a single stop or start
  evidence_ = std::clamp(evidence_ + (std::abs(box_[0] - box_[1]) > change ? 1 : -0.5), 0.0, most_evidence);
  trust_ = evidence_ < least_evidence ? 0 : std::clamp((skill - 0.5) / 0.4, 0.0, 1.0);
}

void Predictor::learn(double usual) {
  const std::array<double, 3> phi{box_[1], box_[2], constant};
  const double error = box_[0] - (theta_[0] * phi[0] + theta_[1] * phi[1] + theta_[2] * phi[2]);
  const double still = quiet + doubt_;
  const bool rest = std::abs(box_[0]) < still && std::abs(box_[1]) < still && std::abs(box_[2]) < still;
  // the target does something else from now on: what was learned counts little against what will be seen
  const bool turn = error * error > surprise * surprise * usual + sudden * sudden;
  if (turn) {
    P_ = {};
    for (int i = 0; i < 3; ++i) P_[4 * i] = first_variance;
  }
  moving_ = rest || turn ? 0 : moving_ + 1;
  // a start or a turn obeys no model of the motion: learn from boxes that lie within the motion only
  if (moving_ < 4) return;

  std::array<double, 3> gain{};
  const double noise = doubt_ / certain;
  double denominator = memory_ * (1 + noise * noise);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) gain[i] += P_[3 * i + j] * phi[j];
    denominator += phi[i] * gain[i];
  }
  for (int i = 0; i < 3; ++i) theta_[i] += gain[i] / denominator * error;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const double updated = (P_[3 * i + j] - gain[i] * gain[j] / denominator) / memory_;
      P_[3 * i + j] = P_[3 * j + i] = std::clamp(updated, -first_variance, first_variance);
    }
  }
}

void Predictor::look_ahead() {
  // boxes -2 ... around the last complete one; a model that runs away is stopped at twice the largest recent speed
  std::array<double, future_size + 2> x{box_[2], box_[1], box_[0]};
  largest_ = std::max(std::abs(box_[0]), forgetting * largest_);
  const double bound = 2 * largest_;
  for (size_t k = 3; k < x.size(); ++k) {
    x[k] = std::clamp(theta_[0] * x[k - 1] + theta_[1] * x[k - 2] + theta_[2] * constant, -bound, bound);
  }
  // what was forecast for the box two ahead now is judged two boxes later
  for (int k = skill_boxes; k > 1; --k) expected_[k] = expected_[k - 1];
  expected_[0] = x[3];
  expected_[1] = x[3 + skill_boxes - 1];

  // a box mean is the centre value plus curvature / 24: take that off again
  // cppcheck-suppress containerOutOfBounds ; x has future_size + 2 elements
  for (int k = 0; k < future_size; ++k) future_[k] = x[k + 1] - (x[k] - 2 * x[k + 1] + x[k + 2]) / 24;
}

Predictor::Forecast Predictor::ahead(double ahead) const {
  // box k of `future_` is centred (k - 1.5) periods after the end of the last complete box
  const double s = (count_ * step_ + ahead) / period_ + 1.5;
  const int k = std::clamp(static_cast<int>(s), 1, future_size - 3);
  const double t = s - k;
  const double a = future_[k - 1], b = future_[k], c = future_[k + 1], d = future_[k + 2];

  // the cubic through four neighbours
  const double c1 = c - a / 3 - b / 2 - d / 6;
  const double c2 = (a + c) / 2 - b;
  const double c3 = (d - a) / 6 + (b - c) / 2;
  return {b + t * (c1 + t * (c2 + t * c3)), (c1 + t * (2 * c2 + t * 3 * c3)) / period_,
          (2 * c2 + t * 6 * c3) / (period_ * period_)};
}

}  // namespace eye
