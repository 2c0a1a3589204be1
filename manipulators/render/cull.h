#pragma once

#include <cstddef>
#include <vector>

#include "manipulators/render/picture.h"
#include "manipulators/render/scene.h"

namespace render {

/// A drawable that can be seen, and how finely.
struct Seen {
  std::size_t drawable = 0;  ///< index into Scene::drawables
  std::size_t level = 0;     ///< index into Geometry::levels
  float distance = 0;        ///< from the camera to the centre of its box [m]
};

/// Six planes; a point is inside when `normal . p + offset >= 0` for all.
struct Frustum {
  Eigen::Matrix<float, 6, 4> planes;
  /// Of a matrix from world to clip coordinates.
  explicit Frustum(const Eigen::Matrix4f& clip_from_world);
  /// False only if the box is certainly outside.
  bool touches(const Eigen::AlignedBox3f& box) const;
};

/// What is inside the camera's frustum and at least `smallest` pixels large on a picture of that size, each with the
/// coarsest level whose error stays below `tolerance` pixels.
std::vector<Seen> seen_by(const Scene& scene, const Camera& camera, Size size, float tolerance = 0.4f,
                          float smallest = 0.7f);

/// Pixels per metre at distance 1 m.
float focal_pixels(const Camera& camera, Size size);

}  // namespace render
