#include "manipulators/render/scene.h"

#include <atomic>
#include <cmath>

namespace render {

namespace {
std::atomic<std::uint64_t> last_id{0};
}

Geometry::Geometry() : id(++last_id) {}

void Geometry::touch() {
  bounds.setEmpty();
  for (const Vertex& vertex : vertices) bounds.extend(vertex.position);
  ++generation;
}

void Geometry::add(std::initializer_list<std::uint32_t> corners) {
  levels[0].indices.insert(levels[0].indices.end(), corners);
}

void Geometry::close() {
  levels[0].spans = {{0, static_cast<std::uint32_t>(levels[0].indices.size()), 0}};
  ++topology;
  touch();
}

std::size_t Geometry::triangle_count(std::size_t level) const {
  return primitive == Primitive::triangles ? levels[level].indices.size() / 3 : 0;
}

std::vector<Light> three_point_lights() {
  auto light = [](Eigen::Vector3f toward, Eigen::Vector3f color, float intensity) {
    return Light{toward.normalized(), true, linear_of(color) * intensity};
  };
  return {
      light({0.55f, 0.95f, 0.85f}, {1.0f, 0.96f, 0.89f}, 1.9f),
      light({-0.9f, 0.35f, 0.7f}, {0.80f, 0.88f, 1.0f}, 0.32f),
      light({-0.35f, 0.75f, -0.9f}, {1.0f, 0.97f, 0.94f}, 0.8f),
  };
}

Eigen::AlignedBox3f world_bounds(const Drawable& drawable) {
  Eigen::AlignedBox3f box;
  if (!drawable.geometry || drawable.geometry->bounds.isEmpty()) return box;
  // the box of a transformed box: centre moves, half sides go through the absolute matrix
  const auto& own = drawable.geometry->bounds;
  const Eigen::Vector3f centre = drawable.X_WG * own.center();
  const Eigen::Vector3f half = drawable.X_WG.linear().cwiseAbs() * (own.sizes() * 0.5f);
  box.extend(centre - half);
  box.extend(centre + half);
  return box;
}

Eigen::Isometry3f looking_at(const Eigen::Vector3f& eye, const Eigen::Vector3f& target) {
  Eigen::Vector3f forward = target - eye;
  if (forward.norm() < 1e-9f) forward = Eigen::Vector3f::UnitZ();
  forward.normalize();
  // straight up or down: any horizontal axis will do
  Eigen::Vector3f left = Eigen::Vector3f::UnitY().cross(forward);
  if (left.norm() < 1e-6f) left = Eigen::Vector3f::UnitX();
  left.normalize();
  Eigen::Isometry3f X_WC = Eigen::Isometry3f::Identity();
  X_WC.linear() << left, forward.cross(left), forward;
  X_WC.translation() = eye;
  return X_WC;
}

Eigen::Matrix4f view_projection(const Camera& camera, float aspect) {
  // OpenGL looks along -Z with +X to the right: turn half around Y
  Eigen::Matrix4f view = camera.X_WC.inverse().matrix();
  view.row(0) *= -1;
  view.row(2) *= -1;
  const float f = 1 / std::tan(camera.field_of_view / 2);
  const float n = camera.near;
  const float r = camera.far;
  Eigen::Matrix4f projection = Eigen::Matrix4f::Zero();
  projection(0, 0) = f / aspect;
  projection(1, 1) = f;
  projection(2, 2) = (r + n) / (n - r);
  projection(2, 3) = 2 * r * n / (n - r);
  projection(3, 2) = -1;
  return projection * view;
}

Eigen::Vector3f linear_of(const Eigen::Vector3f& srgb) {
  return srgb.unaryExpr([](float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); });
}

}  // namespace render
