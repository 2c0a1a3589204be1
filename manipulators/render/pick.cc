#include "manipulators/render/pick.h"

#include <cmath>
#include <limits>

namespace render {

namespace {

// calls hit(t) for every triangle of the finest level that the ray meets (Moeller and Trumbore 1997)
template <typename OnHit>
void intersect(const Drawable& drawable, const Ray& ray, OnHit on_hit) {
  const Geometry& geometry = *drawable.geometry;
  if (geometry.primitive != Primitive::triangles) return;
  const Eigen::Affine3f X_GW = drawable.X_WG.inverse();
  const Eigen::Vector3f o = X_GW * ray.origin;
  const Eigen::Vector3f d = X_GW.linear() * ray.direction;
  const auto& indices = geometry.levels[0].indices;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Eigen::Vector3f& a = geometry.vertices[indices[i]].position;
    const Eigen::Vector3f e1 = geometry.vertices[indices[i + 1]].position - a;
    const Eigen::Vector3f e2 = geometry.vertices[indices[i + 2]].position - a;
    const Eigen::Vector3f p = d.cross(e2);
    const float determinant = e1.dot(p);
    // slivers and triangles seen edge-on have no reliable answer
    if (std::abs(determinant) <= 1e-6f * d.norm() * e1.norm() * e2.norm()) continue;
    const Eigen::Vector3f s = o - a;
    const float u = s.dot(p) / determinant;
    if (!(u >= 0 && u <= 1)) continue;
    const Eigen::Vector3f q = s.cross(e1);
    const float v = d.dot(q) / determinant;
    if (!(v >= 0 && u + v <= 1)) continue;
    const float t = e2.dot(q) / determinant;
    if (t > 0) on_hit(t);
  }
}

// does the ray meet the box, grown a little so that flat ones count?
bool meets(const Ray& ray, const Eigen::AlignedBox3f& box) {
  if (box.isEmpty()) return false;
  float enter = 0;
  float leave = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const float grow = 1e-5f * (1 + std::abs(box.min()[axis]) + std::abs(box.max()[axis]));
    const float low = box.min()[axis] - grow - ray.origin[axis];
    const float high = box.max()[axis] + grow - ray.origin[axis];
    const float d = ray.direction[axis];
    if (std::abs(d) < 1e-20f) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    enter = std::max(enter, std::min(low / d, high / d));
    leave = std::min(leave, std::max(low / d, high / d));
  }
  return enter <= leave;
}

}  // namespace

Ray ray_through(const Camera& camera, Size size, float x, float y) {
  const float t = std::tan(camera.field_of_view / 2);
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  const float right = (2 * x / static_cast<float>(size.width) - 1) * t * aspect;
  const float up = (1 - 2 * y / static_cast<float>(size.height)) * t;
  return {camera.X_WC.translation(), camera.X_WC.linear() * Eigen::Vector3f(-right, up, 1)};
}

std::optional<Hit> pick(const Scene& scene, const Ray& ray) {
  std::optional<Hit> nearest;
  for (std::size_t i = 0; i < scene.drawables.size(); ++i) {
    const Drawable& drawable = scene.drawables[i];
    if (drawable.helper || !drawable.geometry || !meets(ray, world_bounds(drawable))) continue;
    intersect(drawable, ray, [&](float t) {
      if (!nearest || t < nearest->along) nearest = Hit{i, t, ray.origin + t * ray.direction};
    });
  }
  return nearest;
}

int crossings(const Drawable& drawable, const Ray& ray) {
  int count = 0;
  intersect(drawable, ray, [&](float) { ++count; });
  return count;
}

std::optional<Eigen::Vector3f> on_view_plane(const Camera& camera, const Ray& ray, const Eigen::Vector3f& point) {
  const Eigen::Vector3f normal = camera.X_WC.linear().col(2);
  const float along = normal.dot(ray.direction);
  if (std::abs(along) < 1e-9f) return {};
  const float t = normal.dot(point - ray.origin) / along;
  if (!(t > 0)) return {};
  return Eigen::Vector3f(ray.origin + t * ray.direction);
}

}  // namespace render
