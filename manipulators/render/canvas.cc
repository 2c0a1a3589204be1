#include "manipulators/render/canvas.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <numbers>
#include <optional>

#include "manipulators/render/context.h"
#include "manipulators/render/cull.h"
#include "manipulators/render/gl.h"
#include "manipulators/render/shaders.h"
#include "manipulators/render/shapes.h"
#include "manipulators/render/smooth.h"
#include "manipulators/render/text.h"

namespace render {

namespace {

// mirrors the uniform block `Frame`
struct FrameBlock {
  Eigen::Matrix4f clip_from_world;
  Eigen::Matrix4f shadow_from_world = nowhere();
  Eigen::Matrix4f near_from_world = nowhere();
  Eigen::Vector4f ray_centre, ray_right, ray_down;
  Eigen::Vector4f eye, zenith, horizon, earth, picture, shadow;
  Eigen::Vector4f near_shadow = Eigen::Vector4f::Zero();
  Eigen::Vector4f lights, lens;
  Eigen::Vector4f light_toward[most_lights];
  Eigen::Vector4f light_color[most_lights];

  // everything is outside the map
  static Eigen::Matrix4f nowhere() {
    Eigen::Matrix4f matrix = Eigen::Matrix4f::Zero();
    matrix.col(3) << 2, 2, 2, 1;
    return matrix;
  }
};
static_assert(most_lights == 6);

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Eigen::Vector4f extended(const Eigen::Vector3f& v, float w) { return {v.x(), v.y(), v.z(), w}; }

// the corners of the part of the view between two distances
std::array<Eigen::Vector3f, 8> view_corners(const Camera& camera, float aspect, float near, float far) {
  std::array<Eigen::Vector3f, 8> corners;
  const float t = std::tan(camera.field_of_view / 2);
  int k = 0;
  for (float z : {near, far}) {
    for (float x : {-1.0f, 1.0f}) {
      for (float y : {-1.0f, 1.0f}) corners[k++] = camera.X_WC * Eigen::Vector3f(x * t * aspect * z, y * t * z, z);
    }
  }
  return corners;
}

struct ShadowView {
  Eigen::Matrix4f clip_from_world;
  float texel = 0;  // [m]
};

// how far from the camera the nearest thing is that is worth a sharp shadow
float nearest_caster(const Scene& scene, const Camera& camera, const std::vector<Seen>& seen) {
  float nearest = camera.far;
  for (const Seen& one : seen) {
    const Drawable& drawable = scene.drawables[one.drawable];
    if (drawable.scenery || drawable.helper || !drawable.casts_shadow) continue;
    nearest = std::min(nearest, std::sqrt(world_bounds(drawable).squaredExteriorDistance(camera.X_WC.translation())));
  }
  return nearest;
}

// an orthographic view along the key light over what is both seen, up to a distance of `reach`, and shadowed, and deep
// enough for every caster
std::optional<ShadowView> shadow_view(const Scene& scene, const Camera& camera, float aspect, float reach,
                                      int map_size) {
  if (scene.lights.empty()) return {};
  Eigen::AlignedBox3f casters;
  for (const Drawable& drawable : scene.drawables) {
    if (drawable.casts_shadow && !drawable.helper) casters.extend(world_bounds(drawable));
  }
  if (casters.isEmpty()) return {};

  const Light& key = scene.lights[0];
  const Eigen::Vector3f toward =
      key.distant ? key.toward.normalized() : Eigen::Vector3f((key.toward - casters.center()).normalized());
  const Eigen::Vector3f side = toward.unitOrthogonal();
  Eigen::Matrix3f R_LW;
  R_LW << side.transpose(), toward.cross(side).transpose(), toward.transpose();

  Eigen::AlignedBox3f lit;
  for (const Eigen::Vector3f& corner : view_corners(camera, aspect, camera.near, reach)) lit.extend(R_LW * corner);
  Eigen::AlignedBox3f thrown;
  for (int k = 0; k < 8; ++k) {
    thrown.extend(R_LW * casters.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)));
  }
  // a shadow lands anywhere below its caster, so only the sideways extent is cut
  Eigen::Vector3f low = lit.min().cwiseMax(thrown.min());
  Eigen::Vector3f high = lit.max().cwiseMin(thrown.max());
  if (low.x() >= high.x() || low.y() >= high.y()) return {};
  low.z() = std::min(lit.min().z(), thrown.min().z());
  high.z() = thrown.max().z();

  // a square of whole texels, so that edges do not crawl when the camera moves
  float width = std::max(high.x() - low.x(), high.y() - low.y());
  width = std::exp2(std::ceil(std::log2(width) * 4) / 4);
  const float texel = width / static_cast<float>(map_size);
  Eigen::Vector3f centre = (low + high) / 2;
  centre.x() = std::floor(centre.x() / texel) * texel;
  centre.y() = std::floor(centre.y() / texel) * texel;
  const float half = width / 2 + 2 * texel;
  const float depth = std::max(high.z() - low.z(), 0.1f) * 1.02f;

  ShadowView view;
  view.texel = texel;
  view.clip_from_world.setIdentity();
  view.clip_from_world.topLeftCorner<3, 3>() = R_LW;
  view.clip_from_world.topRightCorner<3, 1>() = -centre;
  const Eigen::Vector4f scale(1 / half, 1 / half, -2 / depth, 1);
  view.clip_from_world = scale.asDiagonal() * view.clip_from_world;
  return view;
}

GeometryPointer ground_disc() {
  auto geometry = std::make_shared<Geometry>();
  // rings that are denser near the camera, where the light on them changes with distance
  const std::vector<float> radii = {0,    0.001f, 0.003f, 0.006f, 0.01f, 0.02f, 0.03f, 0.045f, 0.06f, 0.08f,
                                    0.1f, 0.13f,  0.16f,  0.2f,   0.24f, 0.28f, 0.32f, 0.36f,  0.5f,  1};
  constexpr std::uint32_t columns = 64;
  for (float radius : radii) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(c) / columns;
      geometry->vertices.push_back({{radius * std::sin(angle), 0, radius * std::cos(angle)}, {0, 1, 0}, {}});
    }
  }
  for (std::uint32_t r = 0; r + 1 < radii.size(); ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      const std::uint32_t a = r * columns + c;
      const std::uint32_t b = r * columns + (c + 1) % columns;
      geometry->add({a, a + columns, b + columns});
      geometry->add({a, b + columns, b});
    }
  }
  geometry->close();
  return geometry;
}

// a grid over the picture from -1 to 1
GeometryPointer screen_grid(std::uint32_t columns, std::uint32_t rows) {
  auto geometry = std::make_shared<Geometry>();
  for (std::uint32_t r = 0; r <= rows; ++r) {
    for (std::uint32_t c = 0; c <= columns; ++c) {
      geometry->vertices.push_back({{2 * static_cast<float>(c) / static_cast<float>(columns) - 1,
                                     2 * static_cast<float>(r) / static_cast<float>(rows) - 1, 0},
                                    {0, 0, 1},
                                    {}});
      if (r == 0 || c == 0) continue;
      const std::uint32_t d = r * (columns + 1) + c;
      const std::uint32_t b = d - columns - 1;
      geometry->add({b - 1, b, d});
      geometry->add({b - 1, d, d - 1});
    }
  }
  geometry->close();
  return geometry;
}

// a rectangle of the picture in pixels from its upper left corner
struct Rectangle {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom are outside
  int width() const { return std::max(0, right - left); }
  int height() const { return std::max(0, bottom - top); }
};

// clip coordinates to a rectangle with a margin; they are already turned upside down
Rectangle rectangle_of(const Eigen::Vector2f& low, const Eigen::Vector2f& high, Size size) {
  const Eigen::Vector2f half(static_cast<float>(size.width) / 2, static_cast<float>(size.height) / 2);
  const Eigen::Vector2f from = ((low.array() + 1) * half.array()).cwiseMax(-1e6f);
  const Eigen::Vector2f to = ((high.array() + 1) * half.array()).cwiseMin(1e6f);
  const float margin = static_cast<float>(size.height) * 0.02f + 4;
  return {std::clamp(static_cast<int>(from.x() - margin), 0, size.width),
          std::clamp(static_cast<int>(from.y() - margin), 0, size.height),
          std::clamp(static_cast<int>(to.x() + margin), 0, size.width),
          std::clamp(static_cast<int>(to.y() + margin), 0, size.height)};
}

// where there is anything to be lit
Rectangle covered(const Scene& scene, const std::vector<Seen>& seen, const Eigen::Matrix4f& clip_from_world,
                  Size size) {
  Eigen::Vector2f low(2, 2), high(-2, -2);
  for (const Seen& one : seen) {
    const Eigen::AlignedBox3f box = world_bounds(scene.drawables[one.drawable]);
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3f corner = box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k));
      const Eigen::Vector4f c = clip_from_world * Eigen::Vector4f(corner.x(), corner.y(), corner.z(), 1);
      if (c.w() < 1e-3f) return {0, 0, size.width, size.height};
      low = low.cwiseMin(c.head<2>() / c.w());
      high = high.cwiseMax(c.head<2>() / c.w());
    }
  }
  return low.x() > high.x() ? Rectangle() : rectangle_of(low, high, size);
}

// how many rows from the top can show sky: with a ground those above where it ends
int sky_rows(const Scene& scene, const FrameBlock& frame, int height) {
  // from the ground or from below it the sky is everywhere
  const bool above = frame.eye.y() > scene.surroundings.ground_height + 0.05f;
  if (scene.surroundings.ground == Ground::none || !above || frame.ray_down.y() >= -1e-4f) return height;
  const float end = std::max(0.0f, frame.eye.y() - scene.surroundings.ground_height) / frame.horizon.w();
  float lowest = -1;
  for (float side : {-1.0f, 1.0f}) {
    // the ray meets the ground's end where its height over depth is -end, a little less to be safe
    const float level = frame.ray_centre.y() + side * frame.ray_right.y() + 1.5f * end + 0.01f;
    lowest = std::max(lowest, level / -frame.ray_down.y());
  }
  return std::clamp(static_cast<int>((lowest + 1) / 2 * static_cast<float>(height)) + 2, 0, height);
}

// where the ground may be darkened by something: by the key light's shadow or by what stands on it, and, with
// `and_things`, where these things are themselves
Rectangle darkened(const Scene& scene, const Eigen::Matrix4f& clip_from_world, Size size, bool and_things) {
  constexpr float near_by = 0.25f;  // reach of contact shadows [m]
  const Rectangle everything{0, 0, size.width, size.height};
  const float ground = scene.surroundings.ground_height;
  const Light* key = scene.lights.empty() || !scene.lights[0].distant ? nullptr : &scene.lights[0];
  Eigen::Vector2f low(2, 2), high(-2, -2);
  bool behind = false;
  auto add = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector4f c = clip_from_world * Eigen::Vector4f(p.x(), p.y(), p.z(), 1);
    behind = behind || c.w() < 1e-3f;
    if (behind) return;
    low = low.cwiseMin(c.head<2>() / c.w());
    high = high.cwiseMax(c.head<2>() / c.w());
  };
  for (const Drawable& drawable : scene.drawables) {
    if (drawable.helper || drawable.on_top || !drawable.casts_shadow) continue;
    const Eigen::AlignedBox3f box = world_bounds(drawable);
    if (box.isEmpty()) continue;
    for (int k = 0; k < 8 && !behind; ++k) {
      const Eigen::Vector3f corner = box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k));
      if (and_things) add(corner);
      const Eigen::Vector3f away = (corner - box.center()).cwiseSign() * near_by;
      add({corner.x() + away.x(), ground, corner.z() + away.z()});
      if (key && key->toward.y() > 0.02f && corner.y() > ground) {
        add(corner - key->toward * ((corner.y() - ground) / key->toward.y()));
      } else if (key && corner.y() > ground) {
        behind = true;
      }
    }
    if (behind) return everything;
  }
  if (low.x() > high.x()) return {};
  return rectangle_of(low, high, size);
}

// the uniform block without shadow and picture size
FrameBlock frame_block(const Scene& scene, const Camera& camera, float aspect) {
  const Surroundings& around = scene.surroundings;
  FrameBlock frame;
  frame.clip_from_world = view_projection(camera, aspect);
  frame.clip_from_world.row(1) *= -1;
  // the camera's +X points left and its +Y up; rows run downward
  const Eigen::Matrix3f R_WC = camera.X_WC.linear();
  const float t = std::tan(camera.field_of_view / 2);
  frame.ray_centre = extended(R_WC.col(2), 0);
  frame.ray_right = extended(R_WC.col(0) * -t * aspect, 0);
  frame.ray_down = extended(R_WC.col(1) * -t, 0);
  frame.eye = extended(camera.X_WC.translation(), around.time);
  frame.zenith = extended(linear_of(around.zenith), around.ambient);
  frame.horizon = extended(linear_of(around.horizon), camera.far * 0.9f);
  frame.earth = extended(linear_of(around.earth), around.ground_height);
  const std::size_t count = std::min(scene.lights.size(), most_lights);
  for (std::size_t i = 0; i < most_lights; ++i) {
    const Light light = i < count ? scene.lights[i] : Light{Eigen::Vector3f::UnitY(), true, Eigen::Vector3f::Zero()};
    frame.light_toward[i] = extended(light.toward, light.distant ? 1.0f : 0.0f);
    frame.light_color[i] = extended(light.color, 0);
  }
  frame.lights = {static_cast<float>(count), camera.near, camera.far, 0};
  frame.lens = {0.5f / t, 0, 0, 0};
  frame.shadow = {0, 0, 0, static_cast<float>(static_cast<int>(around.ground))};
  return frame;
}

// the mean of every 2 x 2 pixels
Picture halved(const Picture& from) {
  Picture to(Size{from.width() / 2, from.height() / 2});
  const std::size_t row = static_cast<std::size_t>(from.width()) * 4;
  std::uint8_t* out = to.data();
  for (int y = 0; y < to.height(); ++y) {
    const std::uint8_t* upper = from.data() + 2 * row * static_cast<std::size_t>(y);
    for (int x = 0; x < to.width(); ++x, upper += 8) {
      for (int c = 0; c < 4; ++c) {
        *out++ = static_cast<std::uint8_t>((upper[c] + upper[c + 4] + upper[row + c] + upper[row + c + 4] + 2) / 4);
      }
    }
  }
  return to;
}

}  // namespace

class Canvas::State {
 public:
  explicit State(std::unique_ptr<Context> context) : context_(std::move(context)) {}
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  std::string prepare();
  std::string draw(const Scene& scene, const Camera& camera, Size size, Quality quality, Picture& picture);
  const Cost& cost() const { return cost_; }
  std::string description() const { return context_->description(); }

 private:
  // what is kept for one picture size
  struct Targets {
    explicit Targets(Size size)
        : color(gl::Image::Kind::color, size),
          geometry(gl::Image::Kind::floats, size),
          depth(gl::Image::Kind::depth, size),
          lit(gl::Image::Kind::color, size),
          grain(gl::Image::Kind::single, {(size.width + 1) / 2, (size.height + 1) / 2}),
          open(gl::Image::Kind::single, grain.size()) {}
    gl::Image color, geometry, depth, lit, grain, open;
    gl::Target surfaces{&color, &geometry, &depth};
    gl::Target light{&lit, &depth};
    gl::Target occlusion{&grain};
    gl::Target blurred{&open};
    int last_use = 0;
    bool complete() const {
      return surfaces.complete() && light.complete() && occlusion.complete() && blurred.complete();
    }
  };
  struct ShadowMap {
    // far on the left, near, if it has that part, on the right
    ShadowMap(int side, int parts) : depth(gl::Image::Kind::shadow, {parts * side, side}) {}
    gl::Image depth;
    gl::Target target{&depth};
  };

  // one material of one drawable
  struct Item {
    const Drawable* drawable;
    std::size_t level;
    Span span;
    const Material* material;
    float distance;
  };
  struct Items {
    std::vector<Item> solid, clear, top;
  };

  Targets* targets_for(Size size);
  Items sorted_items(const Scene& scene, const std::vector<Seen>& seen) const;
  void upload(FrameBlock& frame, Size size);
  ShadowMap* shadow_map(int side, int parts);
  bool draw_shadows(const Scene& scene, const Camera& camera, float aspect, const std::vector<Seen>& seen, int side,
                    FrameBlock& frame);
  void draw_shadow_map(const Scene& scene, const ShadowView& view, int left, int side);
  void draw_items(const std::vector<Item>& items, bool lit_later, float line_scale);
  void draw_screen(gl::Program& program);
  void draw_ground(const Scene& scene, const FrameBlock& frame, Size size);
  void draw_grid(gl::Program& program, const Geometry& geometry);

  std::unique_ptr<Context> context_;
  std::unique_ptr<gl::Program> surface_, eye_, clear_, flat_, grid_, studio_, studio_far_, sea_, sky_, light_, depth_,
      occlusion_, blur_;
  std::unique_ptr<ShadowMap> shadow_maps_[2];  // of one part and of two
  ShadowMap* shadow_map_ = nullptr;            // that of the picture
  std::unique_ptr<gl::Store> store_;
  std::unique_ptr<gl::Image> nothing_;
  std::map<std::pair<int, int>, std::unique_ptr<Targets>> targets_;
  GLuint frame_buffer_ = 0, empty_array_ = 0;
  GeometryPointer disc_, sky_grid_, cloud_grid_;
  Cost cost_;
  int now_ = 0;
};

Canvas::State::~State() {
  if (!context_->use().empty()) return;
  if (frame_buffer_) glDeleteBuffers(1, &frame_buffer_);
  if (empty_array_) glDeleteVertexArrays(1, &empty_array_);
}

std::string Canvas::State::prepare() {
  if (auto problem = context_->use(); !problem.empty()) return problem;
  using namespace shaders;
  std::string problem;
  auto program = [&](const std::string& vertex, const std::string& fragment) {
    return std::make_unique<gl::Program>(vertex, fragment, problem);
  };
  surface_ = program(surface_vertex(), surface_fragment());
  eye_ = program(surface_vertex(), eye_fragment());
  clear_ = program(surface_vertex(), clear_fragment());
  flat_ = program(surface_vertex(), flat_fragment());
  grid_ = program(ground_vertex(), grid_fragment());
  studio_ = program(studio_vertex(), studio_fragment());
  studio_far_ = program(studio_vertex(), shade_fragment());
  sea_ = program(ground_vertex(), sea_fragment());
  sky_ = program(sky_vertex(), shade_fragment());
  light_ = program(screen_vertex(), light_fragment());
  depth_ = program(depth_vertex(), depth_fragment());
  occlusion_ = program(screen_vertex(), occlusion_fragment());
  blur_ = program(screen_vertex(), blur_fragment());
  if (!problem.empty()) return problem;

  store_ = std::make_unique<gl::Store>();
  disc_ = ground_disc();
  sky_grid_ = screen_grid(16, 32);
  cloud_grid_ = screen_grid(64, 48);
  nothing_ = std::make_unique<gl::Image>(gl::Image::Kind::single, Size{1, 1});
  glGenBuffers(1, &frame_buffer_);
  glGenVertexArrays(1, &empty_array_);
  return {};
}

Canvas::State::Targets* Canvas::State::targets_for(Size size) {
  std::unique_ptr<Targets>& targets = targets_[{size.width, size.height}];
  if (!targets) targets = std::make_unique<Targets>(size);
  targets->last_use = now_;
  if (!targets->complete()) {
    targets_.erase({size.width, size.height});
    return nullptr;
  }
  // three sizes at most (a picture, its inset, a still) are kept
  if (targets_.size() > 3) {
    targets_.erase(std::min_element(targets_.begin(), targets_.end(), [](const auto& a, const auto& b) {
      return a.second->last_use < b.second->last_use;
    }));
  }
  return targets.get();
}

void Canvas::State::upload(FrameBlock& frame, Size size) {
  const auto width = static_cast<float>(size.width);
  const auto height = static_cast<float>(size.height);
  frame.picture = {width, height, 1 / width, 1 / height};
  glBindBuffer(GL_UNIFORM_BUFFER, frame_buffer_);
  glBufferData(GL_UNIFORM_BUFFER, sizeof frame, &frame, GL_STREAM_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer_);
}

void Canvas::State::draw_screen(gl::Program& program) {
  program.use();
  glBindVertexArray(empty_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  ++cost_.calls;
}

void Canvas::State::draw_grid(gl::Program& program, const Geometry& geometry) {
  program.use();
  store_->bind(geometry);
  store_->draw(geometry, 0);
  ++cost_.calls;
}

void Canvas::State::draw_ground(const Scene& scene, const FrameBlock& frame, Size size) {
  const bool near_lights =
      std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return !l.distant; });
  const Ground ground = scene.surroundings.ground;
  if (ground != Ground::studio || near_lights) {
    draw_grid(ground == Ground::sea ? *sea_ : *grid_, *disc_);
    return;
  }
  // shadows are looked for only where there can be any; the rest is drawn behind that
  const Rectangle dark = darkened(scene, frame.clip_from_world, size, false);
  if (dark.width() > 0 && dark.height() > 0) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(dark.left, dark.top, dark.width(), dark.height());
    draw_grid(*studio_, *disc_);
    glDisable(GL_SCISSOR_TEST);
  }
  if (dark.width() == size.width && dark.height() == size.height) return;
  glDepthFunc(GL_LESS);
  draw_grid(*studio_far_, *disc_);
  glDepthFunc(GL_LEQUAL);
}

// null when the rasterizer has none
Canvas::State::ShadowMap* Canvas::State::shadow_map(int side, int parts) {
  std::unique_ptr<ShadowMap>& map = shadow_maps_[parts - 1];
  if (!map || map->depth.size().height != side) map = std::make_unique<ShadowMap>(side, parts);
  if (!map->target.complete()) map.reset();
  return map.get();
}

bool Canvas::State::draw_shadows(const Scene& scene, const Camera& camera, float aspect, const std::vector<Seen>& seen,
                                 int side, FrameBlock& frame) {
  // the nearest thing says how far sharp shadows must reach
  const float nearest = nearest_caster(scene, camera, seen);
  const auto far = shadow_view(scene, camera, aspect, std::clamp(nearest * 2.5f + 2.0f, 2.0f, 30.0f), side);
  auto near = shadow_view(scene, camera, aspect, std::clamp(nearest * 1.3f + 0.3f, 0.5f, 30.0f), side);
  // a second map must be worth its drawing
  if (!far || (near && near->texel > 0.55f * far->texel)) near.reset();
  const int parts = near ? 2 : 1;
  shadow_map_ = shadow_map(side, parts);
  if (!shadow_map_) return false;
  if (!far) return true;

  shadow_map_->target.use();
  glClear(GL_DEPTH_BUFFER_BIT);
  // polygon offset keeps a surface from shadowing itself
  glEnable(GL_POLYGON_OFFSET_FILL);
  glFrontFace(GL_CCW);
  glPolygonOffset(1.5f, 2.0f);
  draw_shadow_map(scene, *far, 0, side);
  if (near) draw_shadow_map(scene, *near, side, side);
  glDisable(GL_POLYGON_OFFSET_FILL);

  // a distance of 2.4 texels keeps coarser levels off the finer ones that they shadow
  constexpr float off = 1.3f;
  Eigen::Matrix4f half = Eigen::Matrix4f::Identity();
  half.diagonal() << 0.5f, 0.5f, 0.5f, 1;
  half.col(3) << 0.5f, 0.5f, 0.5f, 1;
  frame.shadow_from_world = half * far->clip_from_world;
  frame.shadow.head<3>() << off * far->texel, 1 / static_cast<float>(side), 1;
  frame.near_shadow.y() = 1 / static_cast<float>(parts);
  if (!near) return true;
  frame.near_from_world = half * near->clip_from_world;
  frame.near_shadow.x() = off * near->texel;
  return true;
}

void Canvas::State::draw_shadow_map(const Scene& scene, const ShadowView& view, int left, int side) {
  glViewport(left, 0, side, side);
  depth_->use();
  const Frustum frustum(view.clip_from_world);
  for (const Drawable& drawable : scene.drawables) {
    const Geometry& geometry = *drawable.geometry;
    if (!drawable.casts_shadow || drawable.helper || drawable.on_top || geometry.vertices.empty()) continue;
    if (geometry.primitive != Primitive::triangles || drawable.materials.empty()) continue;
    if (drawable.materials[0].opacity < 0.995f || !frustum.touches(world_bounds(drawable))) continue;
    // a shadow needs no finer surface than the distance that it is kept off what throws it
    const float stretch = drawable.X_WG.linear().colwise().norm().maxCoeff();
    std::size_t level = 0;
    while (level + 1 < geometry.levels.size() && geometry.levels[level + 1].error * stretch < view.texel * 2) {
      ++level;
    }
    store_->bind(geometry);
    depth_->set("clip_from_geometry", Eigen::Matrix4f(view.clip_from_world * drawable.X_WG.matrix()));
    if (geometry.closed && drawable.X_WG.linear().determinant() > 0) {
      glEnable(GL_CULL_FACE);
    } else {
      glDisable(GL_CULL_FACE);
    }
    store_->draw(geometry, level);
    ++cost_.calls;
  }
  glDisable(GL_CULL_FACE);
}

void Canvas::State::draw_items(const std::vector<Item>& items, bool lit_later, float line_scale) {
  const Geometry* bound = nullptr;
  const Drawable* placed = nullptr;
  gl::Program* program = nullptr;
  for (const Item& item : items) {
    const Material& material = *item.material;
    const bool flat = material.finish == Finish::unlit || item.drawable->geometry->primitive == Primitive::lines;
    gl::Program* wanted = flat                             ? flat_.get()
                          : !lit_later                     ? clear_.get()
                          : material.finish == Finish::eye ? eye_.get()
                                                           : surface_.get();
    if (wanted != program) {
      program = wanted;
      program->use();
      placed = nullptr;
    }
    if (item.drawable->geometry.get() != bound) {
      bound = item.drawable->geometry.get();
      store_->bind(*bound);
      if (bound->primitive == Primitive::lines) glLineWidth(std::max(1.0f, item.drawable->line_width * line_scale));
    }
    if (item.drawable != placed) {
      placed = item.drawable;
      program->set("world_from_geometry", placed->X_WG.matrix());
      // the cofactor matrix turns normals rightly under any scale, and has no division to fail
      const Eigen::Matrix3f m = placed->X_WG.linear();
      Eigen::Matrix3f cofactor;
      cofactor << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
      program->set("normal_from_geometry",
                   Eigen::Matrix3f(cofactor / std::max(m.col(0).norm() * m.col(1).norm(), 1e-20f)));
      // a mirrored placement would show its inside
      if (bound->closed && m.determinant() > 0) {
        glEnable(GL_CULL_FACE);
      } else {
        glDisable(GL_CULL_FACE);
      }
    }
    const float roughness = std::clamp(material.roughness, 0.13f, 1.0f);
    const bool skin = material.finish == Finish::skin;
    program->set("base", extended(material.color, material.opacity));
    if (material.finish == Finish::eye) {
      program->set("surface", Eigen::Vector4f(material.iris, material.pupil, 0, 0));
    } else {
      // one bit says skin, four roughness, three sheen
      const float code = (skin ? 128.0f : 0.0f) + std::round(roughness * 15) * 8 +
                         std::round(std::clamp(material.sheen, 0.0f, 1.0f) * 7);
      program->set("surface", Eigen::Vector4f(code / 255, 0, roughness, skin ? 1.0f : 0.0f));
    }
    store_->draw(*bound, item.level, item.span);
    ++cost_.calls;
    if (bound->primitive == Primitive::triangles) cost_.triangles += item.span.count / 3;
  }
  glDisable(GL_CULL_FACE);
}

Canvas::State::Items Canvas::State::sorted_items(const Scene& scene, const std::vector<Seen>& seen) const {
  Items items;
  for (const Seen& one : seen) {
    const Drawable& drawable = scene.drawables[one.drawable];
    if (drawable.geometry->vertices.empty() || drawable.materials.empty()) continue;
    for (const Span& span : drawable.geometry->levels[one.level].spans) {
      if (span.count == 0) continue;
      const auto wanted = static_cast<std::size_t>(std::max(span.material, 0));
      const Material& material = drawable.materials[std::min(wanted, drawable.materials.size() - 1)];
      if (material.opacity <= 0) continue;
      // what takes no light, or lets some through, is laid on after the light
      const bool late = material.opacity < 0.995f || material.finish == Finish::unlit ||
                        drawable.geometry->primitive == Primitive::lines;
      auto& list = drawable.on_top ? items.top : late ? items.clear : items.solid;
      list.push_back({&drawable, one.level, span, &material, one.distance});
    }
  }
  // near things first hide far ones cheaply; clear things are laid on from the back
  auto nearer = [](const Item& a, const Item& b) { return a.distance < b.distance; };
  auto farther = [](const Item& a, const Item& b) { return a.distance > b.distance; };
  std::stable_sort(items.solid.begin(), items.solid.end(), nearer);
  std::stable_sort(items.clear.begin(), items.clear.end(), farther);
  return items;
}

std::string Canvas::State::draw(const Scene& scene, const Camera& camera, Size size, Quality quality,
                                Picture& picture) {
  if (auto problem = size_problem(size); !problem.empty()) return problem;
  if (auto problem = context_->use(); !problem.empty()) return problem;
  const double started = cpu_seconds();
  cost_ = {};
  ++now_;

  // a still is drawn at twice the size if that is possible at all
  Size drawn = size;
  if (quality == Quality::best && size_problem({2 * size.width, 2 * size.height}).empty()) {
    drawn = {2 * size.width, 2 * size.height};
  }
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  Targets* targets = targets_for(drawn);
  const int map_side = quality == Quality::best ? 2048 : 1024;
  if (!targets) {
    return "the rasterizer has no frame buffer of " + std::to_string(drawn.width) + "x" + std::to_string(drawn.height);
  }

  const std::vector<Seen> seen = seen_by(scene, camera, drawn);
  cost_.drawn = static_cast<int>(seen.size());
  cost_.culled = static_cast<int>(scene.drawables.size() - seen.size());
  const Items items = sorted_items(scene, seen);

  FrameBlock frame = frame_block(scene, camera, aspect);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);

  if (!draw_shadows(scene, camera, aspect, seen, map_side, frame)) {
    return "the rasterizer has no shadow map of " + std::to_string(map_side) + "x" + std::to_string(map_side);
  }

  // surfaces without light; rows are stored top to bottom, so all is upside down and winds the other way round
  glFrontFace(GL_CW);
  upload(frame, drawn);
  targets->surfaces.use();
  glClear(GL_DEPTH_BUFFER_BIT);
  const bool contact = quality != Quality::draft;
  if (contact) {
    // contact shadows look at the depth of neighbours, drawn or not; light looks only where something was drawn
    const Rectangle where = darkened(scene, frame.clip_from_world, drawn, true);
    glEnable(GL_SCISSOR_TEST);
    glScissor(where.left - 8, where.top - 8, where.width() + 16, where.height() + 16);
    const float nothing[] = {0, 0, 0, 0};
    glClearBufferfv(GL_COLOR, 1, nothing);
    glDisable(GL_SCISSOR_TEST);
  }
  const float line_scale = static_cast<float>(drawn.height) / 720;
  draw_items(items.solid, true, line_scale);

  // contact shadows
  glDisable(GL_DEPTH_TEST);
  shadow_map_->depth.bind(0);
  targets->color.bind(2);
  targets->geometry.bind(3);
  nothing_->bind(1);
  if (contact) {
    upload(frame, targets->grain.size());
    glClearColor(1, 1, 1, 1);
    targets->blurred.use();
    glClear(GL_COLOR_BUFFER_BIT);
    targets->occlusion.use();
    glClear(GL_COLOR_BUFFER_BIT);
    // nothing is hidden from the sky far from everything
    const Rectangle where = darkened(scene, frame.clip_from_world, targets->grain.size(), true);
    glEnable(GL_SCISSOR_TEST);
    glScissor(where.left, where.top, where.width(), where.height());
    draw_screen(*occlusion_);
    targets->grain.bind(1);
    targets->blurred.use();
    draw_screen(*blur_);
    glDisable(GL_SCISSOR_TEST);
    targets->open.bind(1);
    frame.lights.w() = 1;
    upload(frame, drawn);
  }

  // light where surfaces were drawn, then the ground, then the sky where nothing was; all at the far plane,
  // so that the depth test leaves out whole blocks of pixels
  glEnable(GL_DEPTH_TEST);
  targets->light.use();
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);
  const Rectangle things = covered(scene, seen, frame.clip_from_world, drawn);
  glEnable(GL_SCISSOR_TEST);
  glScissor(things.left, things.top, things.width(), things.height());
  draw_screen(*light_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  if (scene.surroundings.ground != Ground::none) draw_ground(scene, frame, drawn);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, drawn.width, sky_rows(scene, frame, drawn.height));
  draw_grid(*sky_, scene.surroundings.ground == Ground::sea ? *cloud_grid_ : *sky_grid_);
  glDisable(GL_SCISSOR_TEST);

  // clear things and explanations
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glDepthMask(GL_FALSE);
  draw_items(items.clear, false, line_scale);
  glDepthMask(GL_TRUE);
  if (!items.top.empty()) {
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_items(items.top, false, line_scale);
  }
  glDisable(GL_BLEND);

  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  picture.resize(drawn);
  glReadPixels(0, 0, drawn.width, drawn.height, GL_RGBA, GL_UNSIGNED_BYTE, picture.data());
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return error == GL_OUT_OF_MEMORY ? "the rasterizer is out of memory" : "the rasterizer refused to draw";
  }
  if (quality == Quality::good) smooth_edges(picture);
  if (drawn != size) picture = halved(picture);
  write_labels(picture, scene.labels);
  store_->age(240);
  cost_.cpu_seconds = cpu_seconds() - started;
  return {};
}

std::unique_ptr<Canvas> Canvas::make(std::string& problem) {
  auto context = make_osmesa_context(problem);
  if (!context) return nullptr;
  auto state = std::make_unique<State>(std::move(context));
  problem = state->prepare();
  if (!problem.empty()) return nullptr;
  return std::unique_ptr<Canvas>(new Canvas(std::move(state)));
}

Canvas::Canvas(std::unique_ptr<State> state) : state_(std::move(state)) {}
Canvas::~Canvas() = default;

std::string Canvas::draw(const Scene& scene, const Camera& camera, Size size, Quality quality, Picture& picture) {
  return state_->draw(scene, camera, size, quality, picture);
}

const Cost& Canvas::cost() const { return state_->cost(); }
std::string Canvas::description() const { return state_->description(); }

}  // namespace render
