#pragma once

#include <optional>

#include "manipulators/render/picture.h"
#include "manipulators/render/scene.h"

namespace render {

struct Ray {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  ///< need not have unit length
};

/// The ray through a point of the picture, in pixels from the upper left corner.
Ray ray_through(const Camera& camera, Size size, float x, float y);

/// The nearest thing on a ray.
struct Hit {
  std::size_t drawable = 0;  ///< index into Scene::drawables
  float along = 0;           ///< in lengths of the ray's direction
  Eigen::Vector3f point;     ///< in the world
};

/// The nearest triangle on the ray; explanations (Drawable::helper) are not hit. Cost: every triangle of the
/// drawables whose boxes the ray meets.
std::optional<Hit> pick(const Scene& scene, const Ray& ray);

/// How often the ray passes through the surface of a drawable.
int crossings(const Drawable& drawable, const Ray& ray);

/// Where a ray meets the plane through `point` that faces the camera; nothing when it runs away from it.
std::optional<Eigen::Vector3f> on_view_plane(const Camera& camera, const Ray& ray, const Eigen::Vector3f& point);

}  // namespace render
