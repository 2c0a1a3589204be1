#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// What is to be drawn, as plain data: no database, no graphics library.
/// Metres, radians, world right-handed with Y up; colours are sRGB in 0..1.
namespace render {

/// One corner of a triangle or one end of a line, in the layout the graphics library is handed. 28 bytes.
struct Vertex {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::UnitY();
  std::array<std::uint8_t, 4> color = {255, 255, 255, 255};  ///< multiplies the material's colour
};
static_assert(sizeof(Vertex) == 28);

/// `count` consecutive indices from `first` that wear one material (an index into Drawable::materials).
struct Span {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  int material = 0;
};

/// One level of detail: an index list over the vertices of its geometry.
struct Level {
  std::vector<std::uint32_t> indices;
  std::vector<Span> spans;
  float error = 0;  ///< how far this surface strays from the finest one, in the geometry's own units
};

enum class Primitive { triangles, lines };

/// Vertices and what joins them. `levels[0]` is the finest. Shared between frames; whoever changes the vertices
/// calls `touch()` so that they are sent to the graphics library again.
struct Geometry {
  Geometry();
  Primitive primitive = Primitive::triangles;
  std::vector<Vertex> vertices;
  std::vector<Level> levels = std::vector<Level>(1);
  bool closed = false;  ///< a solid: its back faces are never seen and need not be drawn
  Eigen::AlignedBox3f bounds;
  std::uint64_t id;              ///< unique in this process
  std::uint64_t generation = 1;  ///< grows with every change of the vertices
  std::uint64_t topology = 1;    ///< grows with every change of the index lists

  /// Recomputes the bounds and marks the vertices as changed.
  void touch();
  /// Appends a triangle or a line to the finest level.
  void add(std::initializer_list<std::uint32_t> corners);
  /// Makes the finest level one span of material 0.
  void close();
  std::size_t triangle_count(std::size_t level = 0) const;
};

using GeometryPointer = std::shared_ptr<const Geometry>;

/// How a surface answers light.
enum class Finish {
  plain,  ///< diffuse with a highlight
  skin,   ///< diffuse light seeps around the terminator, reddish
  eye,    ///< a unit sphere painted as an eyeball looking along its own +Z
  unlit,  ///< its colour, no light: rays, axes, wireframes
};

struct Material {
  Eigen::Vector3f color = {0.8f, 0.8f, 0.8f};
  float roughness = 0.6f;  ///< 0 mirror-like highlight, 1 chalk
  float sheen = 0;         ///< light caught by cloth fibres at grazing angles
  float opacity = 1;
  Finish finish = Finish::plain;
  /// For Finish::eye: the iris colour is `color`; these are half angles seen from the eyeball's centre [rad].
  float iris = 0.49f;
  float pupil = 0.16f;
  bool operator==(const Material&) const = default;
};

/// A geometry somewhere in the world.
struct Drawable {
  std::shared_ptr<const Geometry> geometry;
  Eigen::Affine3f X_WG = Eigen::Affine3f::Identity();  ///< geometry to world
  std::vector<Material> materials = std::vector<Material>(1);
  std::string path;  ///< of the object it stands for; what picking answers
  bool casts_shadow = true;
  bool scenery = false;     ///< too large to matter for where the shadows should be sharp
  bool on_top = false;      ///< drawn over everything else, as bones are
  float line_width = 1.5f;  ///< [pixels at 720 lines], for lines
  bool helper = false;      ///< an explanation (ray, axis, wireframe), not part of the world: never exported or picked
};

struct Camera {
  Eigen::Isometry3f X_WC = Eigen::Isometry3f::Identity();  ///< the camera looks along its own +Z, its +Y is up
  float field_of_view = 0.6f;                              ///< vertical [rad]
  float near = 0.05f;
  float far = 200;
};

struct Light {
  Eigen::Vector3f toward = Eigen::Vector3f::UnitY();  ///< direction to a distant light, or position of a near one [m]
  bool distant = true;
  Eigen::Vector3f color = Eigen::Vector3f::Ones();  ///< linear, times intensity
};

/// The most lights that are drawn; the brightest count first.
inline constexpr std::size_t most_lights = 6;

enum class Ground { none, grid, studio, sea };

/// What surrounds the objects.
struct Surroundings {
  Ground ground = Ground::studio;
  float ground_height = 0;                          ///< [m]
  Eigen::Vector3f zenith = {0.36f, 0.55f, 0.78f};   ///< sky colour overhead
  Eigen::Vector3f horizon = {0.80f, 0.86f, 0.90f};  ///< sky colour at the horizon
  Eigen::Vector3f earth = {0.62f, 0.60f, 0.57f};    ///< colour of the ground and of the light it returns
  float ambient = 0.62f;                            ///< strength of sky and ground light
  float time = 0;                                   ///< simulated time [s], moves the sea
};

/// A line of text on the picture.
struct Label {
  std::string text;
  float x = 0, y = 0;  ///< upper left corner [pixels at 720 lines]; negative counts from the right or bottom edge
  float size = 18;     ///< height of a line [pixels at 720 lines]
  std::array<std::uint8_t, 4> color = {255, 255, 255, 255};
};

/// All of it. `lights[0]` is the one that throws shadows.
struct Scene {
  std::vector<Drawable> drawables;
  std::vector<Light> lights;
  Surroundings surroundings;
  std::vector<Label> labels;
};

/// The usual three: a warm key from the upper left front, a cool fill, a rim from behind.
std::vector<Light> three_point_lights();

/// World box of a drawable.
Eigen::AlignedBox3f world_bounds(const Drawable& drawable);

/// A camera at `eye` looking at `target` with +Y up.
Eigen::Isometry3f looking_at(const Eigen::Vector3f& eye, const Eigen::Vector3f& target);

/// World to clip coordinates (OpenGL's, y up).
Eigen::Matrix4f view_projection(const Camera& camera, float aspect);

/// sRGB to linear light, each component.
Eigen::Vector3f linear_of(const Eigen::Vector3f& srgb);

}  // namespace render
