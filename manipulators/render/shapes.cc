#include "manipulators/render/shapes.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

// a grid of (rows + 1) x (columns + 1) vertices already in `geometry`, as triangles with every `stride`-th line only
void add_grid(Level& level, std::uint32_t rows, std::uint32_t columns, std::uint32_t stride) {
  auto at = [&](std::uint32_t r, std::uint32_t c) { return r * (columns + 1) + c; };
  for (std::uint32_t r = 0; r < rows; r += stride) {
    for (std::uint32_t c = 0; c < columns; c += stride) {
      const std::uint32_t a = at(r, c);
      const std::uint32_t b = at(r + stride, c);
      const std::uint32_t d = at(r, c + stride);
      const std::uint32_t e = at(r + stride, c + stride);
      level.indices.insert(level.indices.end(), {a, b, e, a, e, d});
    }
  }
  level.spans = {{0, static_cast<std::uint32_t>(level.indices.size()), 0}};
}

// a surface of revolution about Z: profile points (radius, z) from top (+Z) to bottom with their normals
struct Ring {
  float radius, z, normal_r, normal_z;
};

std::shared_ptr<Geometry> revolve_z(const std::vector<Ring>& rings, std::uint32_t columns) {
  auto geometry = std::make_shared<Geometry>();
  for (const Ring& ring : rings) {
    for (std::uint32_t c = 0; c <= columns; ++c) {
      const float angle = 2 * pi * static_cast<float>(c % columns) / static_cast<float>(columns);
      const Eigen::Vector3f out(std::cos(angle), std::sin(angle), 0);
      Vertex vertex;
      vertex.position = out * ring.radius + Eigen::Vector3f(0, 0, ring.z);
      vertex.normal = out * ring.normal_r + Eigen::Vector3f(0, 0, ring.normal_z);
      geometry->vertices.push_back(vertex);
    }
  }
  return geometry;
}

// the same about Y, by turning Z into Y
void turn_z_to_y(Geometry& geometry) {
  auto turned = [](const Eigen::Vector3f& v) { return Eigen::Vector3f(v.y(), v.z(), v.x()); };
  for (Vertex& vertex : geometry.vertices) {
    vertex.position = turned(vertex.position);
    vertex.normal = turned(vertex.normal);
  }
}

std::vector<Ring> sphere_rings(int count, float from, float to, float radius, float z) {
  std::vector<Ring> rings;
  for (int i = 0; i <= count; ++i) {
    const float polar = from + (to - from) * static_cast<float>(i) / static_cast<float>(count);
    rings.push_back({radius * std::sin(polar), z + radius * std::cos(polar), std::sin(polar), std::cos(polar)});
  }
  return rings;
}

// one level from all rings; the first and the last ring are points on the axis
GeometryPointer finished(std::shared_ptr<Geometry> geometry, std::uint32_t rows, std::uint32_t columns) {
  add_grid(geometry->levels[0], rows, columns, 1);
  geometry->closed = true;
  ++geometry->topology;
  geometry->touch();
  return geometry;
}

}  // namespace

GeometryPointer unit_sphere() {
  static const GeometryPointer sphere = [] {
    constexpr std::uint32_t rows = 32;
    constexpr std::uint32_t columns = 64;
    auto geometry = revolve_z(sphere_rings(rows, 0, pi, 1, 0), columns);
    geometry->levels.clear();
    for (std::uint32_t stride : {1u, 2u, 4u, 8u}) {
      Level level;
      add_grid(level, rows, columns, stride);
      // a facet's middle is half a step from its corners both ways
      const float step = 2 * pi * static_cast<float>(stride) / static_cast<float>(columns);
      level.error = stride == 1 ? 0 : 1 - std::cos(step / 2) * std::cos(step / 2);
      geometry->levels.push_back(std::move(level));
    }
    geometry->closed = true;
    ++geometry->topology;
    geometry->touch();
    return geometry;
  }();
  return sphere;
}

GeometryPointer unit_box() {
  static const GeometryPointer box = [] {
    auto geometry = std::make_shared<Geometry>();
    for (int axis = 0; axis < 3; ++axis) {
      for (int side : {-1, 1}) {
        const std::uint32_t first = static_cast<std::uint32_t>(geometry->vertices.size());
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        normal[axis] = static_cast<float>(side);
        const Eigen::Vector3f u = Eigen::Vector3f::Unit((axis + 1) % 3) * 0.5f * static_cast<float>(side);
        const Eigen::Vector3f v = Eigen::Vector3f::Unit((axis + 2) % 3) * 0.5f;
        for (const Eigen::Vector3f& corner :
             {Eigen::Vector3f(-u - v), Eigen::Vector3f(u - v), Eigen::Vector3f(u + v), Eigen::Vector3f(v - u)}) {
          geometry->vertices.push_back({normal * 0.5f + corner, normal, {255, 255, 255, 255}});
        }
        geometry->add({first, first + 1, first + 2, first, first + 2, first + 3});
      }
    }
    geometry->closed = true;
    geometry->close();
    return geometry;
  }();
  return box;
}

GeometryPointer unit_cylinder() {
  static const GeometryPointer cylinder = [] {
    // the rims are doubled so that the edge is sharp
    auto geometry = revolve_z(
        {{0, 0.5f, 0, 1}, {1, 0.5f, 0, 1}, {1, 0.5f, 1, 0}, {1, -0.5f, 1, 0}, {1, -0.5f, 0, -1}, {0, -0.5f, 0, -1}},
        48);
    turn_z_to_y(*geometry);
    return finished(geometry, 5, 48);
  }();
  return cylinder;
}

GeometryPointer unit_cone() {
  static const GeometryPointer cone = [] {
    const float s = std::sqrt(0.5f);
    auto geometry = revolve_z({{0, 1, s, s}, {1, 0, s, s}, {1, 0, 0, -1}, {0, 0, 0, -1}}, 24);
    turn_z_to_y(*geometry);
    return finished(geometry, 3, 24);
  }();
  return cone;
}

GeometryPointer capsule(float radius, float length) {
  auto rings = sphere_rings(8, 0, pi / 2, radius, length / 2);
  auto lower = sphere_rings(8, pi / 2, pi, radius, -length / 2);
  rings.insert(rings.end(), lower.begin(), lower.end());
  const auto rows = static_cast<std::uint32_t>(rings.size()) - 1;
  auto geometry = revolve_z(rings, 32);
  turn_z_to_y(*geometry);
  return finished(geometry, rows, 32);
}

GeometryPointer sphere_cap(float half_angle) {
  auto geometry = revolve_z(sphere_rings(16, 0, half_angle, 1, 0), 48);
  add_grid(geometry->levels[0], 16, 48, 1);
  ++geometry->topology;
  geometry->touch();
  return geometry;
}

GeometryPointer limit_cone(const std::vector<float>& half_angles) {
  auto geometry = std::make_shared<Geometry>();
  const auto count = static_cast<std::uint32_t>(half_angles.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    const float azimuth = 2 * pi * static_cast<float>(k) / static_cast<float>(count);
    Vertex rim;
    rim.position = {std::sin(half_angles[k]) * std::cos(azimuth), std::sin(half_angles[k]) * std::sin(azimuth),
                    std::cos(half_angles[k])};
    geometry->vertices.push_back(rim);
    geometry->vertices.push_back({});
    geometry->vertices.back().position.setZero();
    const std::uint32_t next = (k + 1) % count;
    geometry->add({2 * k + 1, 2 * k, 2 * next});
    geometry->add({2 * k + 1, 2 * next, 2 * k});
  }
  geometry->close();
  return geometry;
}

GeometryPointer sector(float from, float to) {
  auto geometry = std::make_shared<Geometry>();
  const int steps = std::clamp(static_cast<int>(std::ceil(std::abs(to - from) / 0.1f)), 1, 128);
  geometry->vertices.push_back({Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitZ(), {255, 255, 255, 255}});
  for (int i = 0; i <= steps; ++i) {
    const float angle = from + (to - from) * static_cast<float>(i) / static_cast<float>(steps);
    geometry->vertices.push_back(
        {{std::cos(angle), std::sin(angle), 0}, Eigen::Vector3f::UnitZ(), {255, 255, 255, 255}});
  }
  for (int i = 1; i <= steps; ++i) {
    const auto k = static_cast<std::uint32_t>(i);
    geometry->add({0, k, k + 1});
    geometry->add({0, k + 1, k});
  }
  geometry->close();
  return geometry;
}

GeometryPointer tube(const std::vector<Eigen::Vector3f>& points, const std::vector<float>& radii,
                     const std::vector<std::array<std::uint8_t, 4>>& colors, int sides) {
  auto geometry = std::make_shared<Geometry>();
  Eigen::Vector3f across = Eigen::Vector3f::Zero();
  const auto columns = static_cast<std::uint32_t>(sides);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& before = points[i == 0 ? 0 : i - 1];
    const Eigen::Vector3f& after = points[std::min(i + 1, points.size() - 1)];
    Eigen::Vector3f along = after - before;
    along = along.norm() > 1e-9f ? along.normalized() : Eigen::Vector3f::UnitY();
    // carry the frame along without twist
    across -= along * along.dot(across);
    if (across.norm() < 1e-3f) across = along.unitOrthogonal();
    across.normalize();
    const Eigen::Vector3f third = along.cross(across);
    for (std::uint32_t c = 0; c <= columns; ++c) {
      const float angle = 2 * pi * static_cast<float>(c % columns) / static_cast<float>(columns);
      Vertex vertex;
      vertex.normal = across * std::cos(angle) + third * std::sin(angle);
      vertex.position = points[i] + vertex.normal * radii[i];
      if (!colors.empty()) vertex.color = colors[i];
      geometry->vertices.push_back(vertex);
    }
  }
  if (points.size() < 2) {
    geometry->vertices.clear();
    geometry->close();
    return geometry;
  }
  // rows run along the tube, so the grid winds outward when seen from outside
  for (std::uint32_t r = 0; r + 1 < points.size(); ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t a = r * (columns + 1) + c;
      const std::uint32_t b = a + columns + 1;
      geometry->add({a, a + 1, b + 1});
      geometry->add({a, b + 1, b});
    }
  }
  const auto last = static_cast<std::uint32_t>(points.size() - 1) * (columns + 1);
  for (std::uint32_t c = 1; c + 1 < columns; ++c) {
    geometry->add({0, c + 1, c});
    geometry->add({last, last + c, last + c + 1});
  }
  geometry->closed = true;
  geometry->close();
  return geometry;
}

GeometryPointer segments(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<std::array<std::uint8_t, 4>>& colors) {
  auto geometry = std::make_shared<Geometry>();
  geometry->primitive = Primitive::lines;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vertex vertex;
    vertex.position = points[i];
    if (!colors.empty()) vertex.color = colors[i];
    geometry->vertices.push_back(vertex);
    geometry->levels[0].indices.push_back(static_cast<std::uint32_t>(i));
  }
  geometry->close();
  return geometry;
}

void recompute_normals(Geometry& geometry) {
  std::vector<Eigen::Vector3f> sums(geometry.vertices.size(), Eigen::Vector3f::Zero());
  const auto& indices = geometry.levels[0].indices;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Eigen::Vector3f& a = geometry.vertices[indices[i]].position;
    const Eigen::Vector3f& b = geometry.vertices[indices[i + 1]].position;
    const Eigen::Vector3f& c = geometry.vertices[indices[i + 2]].position;
    // the cross product is twice the area times the normal
    const Eigen::Vector3f n = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) sums[indices[i + k]] += n;
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const float length = sums[v].norm();
    geometry.vertices[v].normal = length > 1e-20f ? Eigen::Vector3f(sums[v] / length) : Eigen::Vector3f::UnitY();
  }
}

std::array<std::uint8_t, 4> heat(double x) {
  if (!std::isfinite(x)) return {128, 128, 128, 255};
  constexpr double stops[5][3] = {
      {0.16, 0.18, 0.48}, {0.13, 0.55, 0.62}, {0.55, 0.78, 0.38}, {0.98, 0.82, 0.25}, {0.84, 0.16, 0.13}};
  const double at = std::clamp(x, 0.0, 1.0) * 4;
  const int k = std::min(3, static_cast<int>(at));
  std::array<std::uint8_t, 4> color{0, 0, 0, 255};
  for (int c = 0; c < 3; ++c) {
    color[c] = static_cast<std::uint8_t>(255 * (stops[k][c] + (at - k) * (stops[k + 1][c] - stops[k][c])) + 0.5);
  }
  return color;
}

void add_levels(Geometry& geometry) {
  if (geometry.primitive != Primitive::triangles || geometry.vertices.empty()) return;
  const float* positions = geometry.vertices[0].position.data();
  const std::size_t vertex_count = geometry.vertices.size();
  const float scale = meshopt_simplifyScale(positions, vertex_count, sizeof(Vertex));
  // shares of the largest extent: on a person half a millimetre, two, six and two centimetres
  for (float share : {0.0003f, 0.0012f, 0.0035f, 0.012f}) {
    const Level& finer = geometry.levels.back();
    if (finer.indices.size() < 3 * 400) break;
    // each span is simplified by itself, so that the borders between materials stay where they are
    Level coarser;
    float worst = 0;
    for (const Span& span : finer.spans) {
      std::vector<std::uint32_t> kept(span.count);
      float error = 0;
      const std::size_t count =
          meshopt_simplify(kept.data(), finer.indices.data() + span.first, span.count, positions, vertex_count,
                           sizeof(Vertex), 0, share, meshopt_SimplifyLockBorder, &error);
      worst = std::max(worst, error * scale);
      coarser.spans.push_back(
          {static_cast<std::uint32_t>(coarser.indices.size()), static_cast<std::uint32_t>(count), span.material});
      coarser.indices.insert(coarser.indices.end(), kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(count));
    }
    coarser.error = finer.error + worst;
    if (coarser.indices.size() > finer.indices.size() * 4 / 5) continue;
    geometry.levels.push_back(std::move(coarser));
  }
  // triangles that share corners follow each other, so that a corner is transformed once
  for (Level& level : geometry.levels) {
    for (const Span& span : level.spans) {
      std::uint32_t* first = level.indices.data() + span.first;
      meshopt_optimizeVertexCache(first, first, span.count, vertex_count);
    }
  }
  ++geometry.topology;
}

}  // namespace render
