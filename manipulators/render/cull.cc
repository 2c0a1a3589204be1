#include "manipulators/render/cull.h"

#include <algorithm>
#include <cmath>

namespace render {

Frustum::Frustum(const Eigen::Matrix4f& clip_from_world) {
  // -w <= x,y,z <= w  (Gribb and Hartmann)
  for (int axis = 0; axis < 3; ++axis) {
    planes.row(2 * axis) = clip_from_world.row(3) + clip_from_world.row(axis);
    planes.row(2 * axis + 1) = clip_from_world.row(3) - clip_from_world.row(axis);
  }
}

bool Frustum::touches(const Eigen::AlignedBox3f& box) const {
  if (box.isEmpty()) return false;
  const Eigen::Vector3f centre = box.center();
  const Eigen::Vector3f half = box.sizes() * 0.5f;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3f normal = planes.row(i).head<3>();
    if (normal.dot(centre) + normal.cwiseAbs().dot(half) + planes(i, 3) < 0) return false;
  }
  return true;
}

float focal_pixels(const Camera& camera, Size size) {
  return static_cast<float>(size.height) / (2 * std::tan(camera.field_of_view / 2));
}

std::vector<Seen> seen_by(const Scene& scene, const Camera& camera, Size size, float tolerance, float smallest) {
  std::vector<Seen> seen;
  const Frustum frustum(view_projection(camera, static_cast<float>(size.width) / static_cast<float>(size.height)));
  const Eigen::Vector3f eye = camera.X_WC.translation();
  const float focal = focal_pixels(camera, size);

  for (std::size_t i = 0; i < scene.drawables.size(); ++i) {
    const Drawable& drawable = scene.drawables[i];
    const Eigen::AlignedBox3f box = world_bounds(drawable);
    if (!frustum.touches(box)) continue;
    const float nearest = std::max(std::sqrt(box.squaredExteriorDistance(eye)), camera.near);
    const float pixels_per_metre = focal / nearest;
    if (box.diagonal().norm() * pixels_per_metre < smallest && !drawable.helper) continue;

    // errors are in the geometry's units: scale by the largest stretch
    const float stretch = drawable.X_WG.linear().colwise().norm().maxCoeff();
    const auto& levels = drawable.geometry->levels;
    std::size_t level = 0;
    while (level + 1 < levels.size() && levels[level + 1].error * stretch * pixels_per_metre < tolerance) ++level;
    seen.push_back({i, level, (box.center() - eye).norm()});
  }
  return seen;
}

}  // namespace render
