#pragma once

#include "manipulators/render/picture.h"
#include "manipulators/render/scene.h"

namespace render {

/// A camera that a person moves about a point.
class Navigator {
 public:
  /// Starts where `camera` is; it turns about the point `distance` ahead of it.
  void start(const Camera& camera, float distance);
  /// Turns about the point, by angles [rad]: to the right and up. It never goes over the top.
  void orbit(float right, float up);
  /// Shifts everything by pixels of a picture of that size, so that the point keeps under the pointer.
  void pan(float pixels_right, float pixels_down, Size size);
  /// Goes nearer (factor < 1) or farther.
  void zoom(float factor);
  Camera camera() const;
  const Eigen::Vector3f& centre() const { return centre_; }
  float distance() const { return distance_; }

 private:
  Camera lens_;
  Eigen::Vector3f centre_ = Eigen::Vector3f::Zero();
  float azimuth_ = 0;  // of the eye as seen from the centre, from +Z toward +X
  float elevation_ = 0;
  float distance_ = 1;
};

}  // namespace render
