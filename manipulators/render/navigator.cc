#include "manipulators/render/navigator.h"

#include <algorithm>
#include <cmath>

namespace render {

namespace {
constexpr float steepest = 1.55f;  // just short of a quarter turn, where "up" would flip [rad]
}

void Navigator::start(const Camera& camera, float distance) {
  lens_ = camera;
  distance_ = std::max(distance, 1e-3f);
  const Eigen::Vector3f forward = camera.X_WC.linear().col(2);
  centre_ = camera.X_WC.translation() + forward * distance_;
  azimuth_ = std::atan2(-forward.x(), -forward.z());
  elevation_ = std::clamp(std::asin(std::clamp(-forward.y(), -1.0f, 1.0f)), -steepest, steepest);
}

void Navigator::orbit(float right, float up) {
  azimuth_ += right;
  elevation_ = std::clamp(elevation_ + up, -steepest, steepest);
}

void Navigator::pan(float pixels_right, float pixels_down, Size size) {
  const float metres = 2 * distance_ * std::tan(lens_.field_of_view / 2) / static_cast<float>(size.height);
  const Eigen::Matrix3f R_WC = camera().X_WC.linear();
  // the camera's +X points left
  centre_ += R_WC.col(0) * (pixels_right * metres) + R_WC.col(1) * (pixels_down * metres);
}

void Navigator::zoom(float factor) { distance_ = std::clamp(distance_ * factor, 2 * lens_.near, lens_.far); }

Camera Navigator::camera() const {
  Camera camera = lens_;
  const Eigen::Vector3f away(std::cos(elevation_) * std::sin(azimuth_), std::sin(elevation_),
                             std::cos(elevation_) * std::cos(azimuth_));
  camera.X_WC = looking_at(centre_ + away * distance_, centre_);
  return camera;
}

}  // namespace render
