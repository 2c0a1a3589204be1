// Frames of the sailor and of ten sailors at 1280 x 720, beside what the rasterizer needs for the same triangles
// without any scene, and beside VTK's off-screen renderer. Processor time of all threads, best of several rounds that
// take turns, because the machine may be busy.
//
//   render_bench [--figure WORLD.dlg] [--rounds N] [--without-vtk]
//
// The sailor is made by the dialog manager from scripts/figures; VTK is asked through Python when it is there.

#include <CLI/CLI.hpp>
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "manipulators/render/canvas.h"
#include "manipulators/render/context.h"
#include "manipulators/render/declaration.h"
#include "manipulators/render/gl.h"
#include "manipulators/render/look.h"
#include "manipulators/render/shapes.h"
#include "manipulators/render/stage.h"
#include "manipulators/render/world_file.h"

namespace {

using namespace render;

constexpr Size size{1280, 720};

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// a saved world with one sailor
std::string make_figure(const std::string& folder) {
  const std::string world = folder + "/sailor.dlg";
  const std::string figures = std::string(SOURCE_DIR) + "/scripts/figures/";
  const std::string command =
      std::string(BIN_DIR) + "/dialog_manager -c 'start render' -c 'create node sailor' -c 'source " + figures +
      "skeleton.dlg under sailor' -c 'source " + figures + "body.dlg under sailor' -c 'save " + world + "'";
  return std::system(command.c_str()) == 0 ? world : "";
}

// the whole scene as one geometry in world coordinates, colours at the vertices
std::shared_ptr<Geometry> merged(const Scene& scene) {
  auto all = std::make_shared<Geometry>();
  for (const Drawable& drawable : scene.drawables) {
    const auto first = static_cast<std::uint32_t>(all->vertices.size());
    const Level& level = drawable.geometry->levels[0];
    for (const Vertex& vertex : drawable.geometry->vertices) {
      Vertex moved = vertex;
      moved.position = drawable.X_WG * vertex.position;
      moved.normal = (drawable.X_WG.linear() * vertex.normal).normalized();
      all->vertices.push_back(moved);
    }
    for (const Span& span : level.spans) {
      const Material& material =
          drawable.materials[std::min<std::size_t>(span.material, drawable.materials.size() - 1)];
      if (material.opacity <= 0) continue;
      for (std::uint32_t i = span.first; i < span.first + span.count; ++i) {
        const std::uint32_t v = first + level.indices[i];
        for (int c = 0; c < 3; ++c) all->vertices[v].color[c] = static_cast<std::uint8_t>(material.color[c] * 255);
        all->levels[0].indices.push_back(v);
      }
    }
  }
  all->close();
  return all;
}

// nothing but the rasterizer: one array, one call, one shader, one read-back
class Bare {
 public:
  Bare(const Geometry& geometry, bool lit)
      : context_(make_osmesa_context(problem_)), count_(static_cast<int>(geometry.levels[0].indices.size())) {
    context_->use();
    program_ = std::make_unique<gl::Program>(vertex_shader, lit ? lit_shader : flat_shader, problem_);
    color_ = std::make_unique<gl::Image>(gl::Image::Kind::color, size);
    depth_ = std::make_unique<gl::Image>(gl::Image::Kind::depth, size);
    target_ = std::make_unique<gl::Target>(std::initializer_list<const gl::Image*>{color_.get(), depth_.get()});
    store_ = std::make_unique<gl::Store>();
    store_->bind(geometry);
  }

  void draw(const Geometry& geometry, const Camera& camera, Picture& picture) {
    context_->use();
    target_->use();
    glEnable(GL_DEPTH_TEST);
    glClearColor(0.7f, 0.75f, 0.8f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    program_->use();
    program_->set("clip_from_world", view_projection(camera, 1280.0f / 720));
    const Eigen::Vector3f eye = camera.X_WC.translation();
    program_->set("eye", Eigen::Vector4f(eye.x(), eye.y(), eye.z(), 1));
    store_->bind(geometry);
    store_->draw(geometry, 0);
    picture.resize(size);
    glReadPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, picture.data());
  }

 private:
  static constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
uniform mat4 clip_from_world;
out vec3 p;
out vec3 n;
out vec4 tint;
void main() { p = position; n = normal; tint = color; gl_Position = clip_from_world * vec4(position, 1.0); }
)";
  static constexpr const char* flat_shader = R"(#version 330 core
in vec4 tint;
out vec4 pixel;
void main() { pixel = tint; }
)";
  // three distant lights, Blinn and Phong
  static constexpr const char* lit_shader = R"(#version 330 core
in vec3 p;
in vec3 n;
in vec4 tint;
uniform vec4 eye;
out vec4 pixel;
void main() {
  vec3 m = normalize(n);
  vec3 v = normalize(eye.xyz - p);
  vec3 sum = tint.rgb * 0.2;
  vec3 l[3] = vec3[3](vec3(0.4, 0.7, 0.6), vec3(-0.75, 0.3, 0.58), vec3(-0.29, 0.61, -0.74));
  for (int i = 0; i < 3; ++i) {
    sum += tint.rgb * max(dot(m, l[i]), 0.0) * 0.5;
    sum += 0.1 * pow(max(dot(m, normalize(l[i] + v)), 0.0), 20.0);
  }
  pixel = vec4(sum, 1.0);
}
)";
  std::string problem_;
  std::unique_ptr<Context> context_;
  std::unique_ptr<gl::Program> program_;
  std::unique_ptr<gl::Image> color_, depth_;
  std::unique_ptr<gl::Target> target_;
  std::unique_ptr<gl::Store> store_;
  int count_;
};

// the same picture as a draft of the scene, as plainly as it can be drawn: a shadow map of all triangles, then
// triangles, ground and sky lit in one pass
class BareScene {
 public:
  explicit BareScene(const Geometry& geometry) : context_(make_osmesa_context(problem_)) {
    context_->use();
    lit_ = std::make_unique<gl::Program>(vertex_shader, std::string(head) + lit_shader, problem_);
    sky_ = std::make_unique<gl::Program>(vertex_shader, std::string(head) + sky_shader, problem_);
    depth_only_ = std::make_unique<gl::Program>(vertex_shader, "#version 330 core\nvoid main() {}\n", problem_);
    target_ = std::make_unique<gl::Target>(std::initializer_list<const gl::Image*>{&color_, &depth_});
    map_target_ = std::make_unique<gl::Target>(std::initializer_list<const gl::Image*>{&map_});
    store_ = std::make_unique<gl::Store>();
    auto plane = std::make_shared<Geometry>();
    for (const auto& [x, z] : {std::pair{-99, -99}, {-99, 99}, {99, 99}, {99, -99}}) {
      plane->vertices.push_back({{static_cast<float>(x), 0, static_cast<float>(z)}, {0, 1, 0}, {158, 153, 145, 255}});
    }
    plane->add({0, 1, 2});
    plane->add({0, 2, 3});
    plane->close();
    ground_ = plane;
    auto dome = std::make_shared<Geometry>();
    for (const auto& [x, y] : {std::pair{-1, -1}, {3, -1}, {-1, 3}}) {
      dome->vertices.push_back({{static_cast<float>(x), static_cast<float>(y), 1}, {0, 0, 1}, {}});
    }
    dome->add({0, 1, 2});
    dome->close();
    screen_ = dome;

    const Eigen::Vector3f toward = Eigen::Vector3f(0.4f, 0.7f, 0.6f).normalized();
    const Eigen::Vector3f side = toward.unitOrthogonal();
    const float reach = geometry.bounds.diagonal().norm() * 0.5f;
    Eigen::Matrix4f look = Eigen::Matrix4f::Identity();
    look.topLeftCorner<3, 3>() << side.transpose(), toward.cross(side).transpose(), toward.transpose();
    look.topRightCorner<3, 1>() = -look.topLeftCorner<3, 3>() * geometry.bounds.center();
    clip_from_light_ = Eigen::Vector4f(1 / reach, 1 / reach, -1 / (2 * reach), 1).asDiagonal() * look;
  }

  void draw(const Geometry& geometry, const Camera& camera, Picture& picture) {
    context_->use();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glClearColor(0, 0, 0, 1);
    map_target_->use();
    glClear(GL_DEPTH_BUFFER_BIT);
    paint(*depth_only_, clip_from_light_, camera, geometry);
    target_->use();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    map_.bind(0);
    const Eigen::Matrix4f clip_from_world = view_projection(camera, 1280.0f / 720);
    paint(*lit_, clip_from_world, camera, geometry);
    paint(*lit_, clip_from_world, camera, *ground_);
    paint(*sky_, Eigen::Matrix4f::Identity(), camera, *screen_);
    picture.resize(size);
    glReadPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, picture.data());
  }

 private:
  void paint(gl::Program& program, const Eigen::Matrix4f& clip, const Camera& camera, const Geometry& geometry) {
    program.use();
    program.set("clip_from_world", clip);
    program.set("map_from_world", clip_from_light_);
    const Eigen::Vector3f eye = camera.X_WC.translation();
    program.set("eye", Eigen::Vector4f(eye.x(), eye.y(), eye.z(), 1));
    store_->bind(geometry);
    store_->draw(geometry, 0);
  }

  static constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
uniform mat4 clip_from_world;
uniform mat4 map_from_world;
out vec3 p;
out vec3 n;
out vec3 s;
out vec4 tint;
void main() {
  p = position;
  n = normal;
  s = (map_from_world * vec4(position + 0.004 * normal, 1.0)).xyz * 0.5 + 0.5;
  tint = color;
  gl_Position = clip_from_world * vec4(position, 1.0);
}
)";
  static constexpr const char* head = R"(#version 330 core
in vec3 p;
in vec3 n;
in vec3 s;
in vec4 tint;
uniform vec4 eye;
uniform sampler2DShadow shadow_map;
out vec4 pixel;
)";
  // three distant lights, Blinn and Phong, the first with a shadow of four samples; displayed with a gamma
  static constexpr const char* lit_shader = R"(
void main() {
  vec3 m = normalize(n);
  vec3 v = normalize(eye.xyz - p);
  vec3 sum = tint.rgb * 0.2;
  float t = 0.0009;
  float open = 0.25 * (texture(shadow_map, s + vec3(t, t, 0.0)) + texture(shadow_map, s + vec3(-t, t, 0.0)) +
                       texture(shadow_map, s + vec3(t, -t, 0.0)) + texture(shadow_map, s + vec3(-t, -t, 0.0)));
  vec3 l[3] = vec3[3](vec3(0.4, 0.7, 0.6), vec3(-0.75, 0.3, 0.58), vec3(-0.29, 0.61, -0.74));
  for (int i = 0; i < 3; ++i) {
    float gain = i == 0 ? open : 1.0;
    sum += gain * tint.rgb * max(dot(m, l[i]), 0.0) * 0.5;
    sum += gain * 0.1 * pow(max(dot(m, normalize(l[i] + v)), 0.0), 20.0);
  }
  pixel = vec4(sqrt(sum), 1.0);
}
)";
  static constexpr const char* sky_shader = R"(
void main() { pixel = vec4(mix(vec3(0.8, 0.86, 0.9), vec3(0.36, 0.55, 0.78), clamp(p.y, 0.0, 1.0)), 1.0); }
)";
  std::string problem_;
  std::unique_ptr<Context> context_;
  bool current_ = context_->use().empty();
  gl::Image color_{gl::Image::Kind::color, size}, depth_{gl::Image::Kind::depth, size};
  gl::Image map_{gl::Image::Kind::shadow, {1024, 1024}};
  std::unique_ptr<gl::Program> lit_, sky_, depth_only_;
  std::unique_ptr<gl::Target> target_, map_target_;
  std::unique_ptr<gl::Store> store_;
  GeometryPointer ground_, screen_;
  Eigen::Matrix4f clip_from_light_;
};

// the camera of frame k: a slow arc, so that no two frames are alike
Camera camera_of_frame(int k, float distance) {
  const float angle = 0.3f + 0.01f * static_cast<float>(k);
  Camera camera;
  camera.field_of_view = 0.6f;
  camera.X_WC = looking_at({distance * std::sin(angle), 1.2f, distance * std::cos(angle)}, {0, 0.9f, 0});
  return camera;
}

struct Row {
  std::string name;
  std::function<void(int)> frame;
  double best = std::numeric_limits<double>::infinity();
};

// writes the triangles for VTK: ASCII PLY-like text would be slow to read, so raw little-endian arrays
void write_arrays(const Geometry& geometry, const std::string& folder) {
  std::ofstream points(folder + "/points.f32", std::ios::binary);
  std::ofstream normals(folder + "/normals.f32", std::ios::binary);
  std::ofstream colors(folder + "/colors.u8", std::ios::binary);
  std::ofstream triangles(folder + "/triangles.u32", std::ios::binary);
  for (const Vertex& vertex : geometry.vertices) {
    points.write(reinterpret_cast<const char*>(vertex.position.data()), 12);
    normals.write(reinterpret_cast<const char*>(vertex.normal.data()), 12);
    colors.write(reinterpret_cast<const char*>(vertex.color.data()), 3);
  }
  const auto& indices = geometry.levels[0].indices;
  triangles.write(reinterpret_cast<const char*>(indices.data()), static_cast<std::streamsize>(indices.size() * 4));
}

void measure(const std::string& title, const Scene& scene, float distance, int rounds, const std::string& folder,
             bool with_vtk) {
  const std::shared_ptr<Geometry> whole = merged(scene);
  Scene one;
  one.lights = scene.lights;
  one.surroundings = scene.surroundings;
  one.drawables.emplace_back();
  one.drawables[0].geometry = whole;
  one.drawables[0].materials[0].color = {1, 1, 1};

  std::string problem;
  auto canvas = Canvas::make(problem);
  if (!canvas) {
    std::fprintf(stderr, "render_bench: %s\n", problem.c_str());
    std::exit(1);
  }
  Bare flat(*whole, false);
  Bare lit(*whole, true);
  BareScene bare_scene(*whole);
  Picture picture;
  std::vector<Row> rows = {
      {"bare: flat colour", [&](int k) { flat.draw(*whole, camera_of_frame(k, distance), picture); }},
      {"bare: three lights per pixel", [&](int k) { lit.draw(*whole, camera_of_frame(k, distance), picture); }},
      {"bare: with shadow map, ground and sky",
       [&](int k) { bare_scene.draw(*whole, camera_of_frame(k, distance), picture); }},
      {"draft, one array without scene",
       [&](int k) { canvas->draw(one, camera_of_frame(k, distance), size, Quality::draft, picture); }},
      {"draft, the scene",
       [&](int k) { canvas->draw(scene, camera_of_frame(k, distance), size, Quality::draft, picture); }},
      {"good, one array without scene",
       [&](int k) { canvas->draw(one, camera_of_frame(k, distance), size, Quality::good, picture); }},
      {"good, the scene",
       [&](int k) { canvas->draw(scene, camera_of_frame(k, distance), size, Quality::good, picture); }},
      {"best, the scene",
       [&](int k) { canvas->draw(scene, camera_of_frame(k, distance), size, Quality::best, picture); }},
  };
  for (int round = 0; round < rounds + 1; ++round) {
    for (Row& row : rows) {
      const double started = cpu_seconds();
      row.frame(round);
      // the first round compiles and uploads
      if (round > 0) row.best = std::min(row.best, cpu_seconds() - started);
    }
  }
  std::printf("\n%s: %zu triangles, %zu drawables, %dx%d\n", title.c_str(), whole->triangle_count(),
              scene.drawables.size(), size.width, size.height);
  std::printf("  %-44s %10s %16s\n", "", "CPU ms", "CPU frames/s");
  for (const Row& row : rows) std::printf("  %-44s %10.1f %16.1f\n", row.name.c_str(), row.best * 1e3, 1 / row.best);
  std::printf("  draft / bare three lights %.2f, draft / bare with shadow, ground and sky %.2f, good / the same %.2f\n",
              rows[4].best / rows[1].best, rows[4].best / rows[2].best, rows[6].best / rows[2].best);
  if (!with_vtk) return;
  write_arrays(*whole, folder);
  std::fflush(stdout);
  const std::string command = "/usr/bin/python3 " + std::string(SOURCE_DIR) + "/tests/bench/render_vtk.py " + folder +
                              " " + std::to_string(distance) + " " + std::to_string(rounds);
  if (std::system(command.c_str()) != 0) std::printf("  VTK: not measured\n");
}

// an arm that goes up and down, to be deformed, uploaded and drawn every frame
void measure_moving(objdb::Database& world, int rounds) {
  Stage stage;
  std::string problem;
  auto canvas = Canvas::make(problem);
  Picture picture;
  double best_stage = std::numeric_limits<double>::infinity();
  double best_draw = best_stage;
  const objdb::Object* joint = world.find("sailor/right_el_x");
  for (int k = 0; k < rounds + 1; ++k) {
    if (joint) {
      if (!world.set(*joint, joint->type->find("angle"), 0.5 + 0.02 * k)) return;
    }
    double started = cpu_seconds();
    const Scene scene = stage.compose(world, nullptr, 0);
    const double composed = cpu_seconds() - started;
    started = cpu_seconds();
    canvas->draw(scene, camera_of_frame(k, 3.4f), size, Quality::good, picture);
    if (k == 0) continue;
    best_stage = std::min(best_stage, composed);
    best_draw = std::min(best_draw, cpu_seconds() - started);
  }
  std::printf("\na moving sailor, good: pose and skin %.1f ms + picture %.1f ms\n", best_stage * 1e3, best_draw * 1e3);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Frames per second of the sailor, beside the bare rasterizer and VTK.");
  std::string figure;
  int rounds = 8;
  bool without_vtk = false;
  app.add_option("--figure", figure, "a saved world with a figure named sailor");
  app.add_option("--rounds", rounds, "pictures of each kind")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_flag("--without-vtk", without_vtk, "leave VTK out");
  CLI11_PARSE(app, argc, argv);

  std::string folder = std::filesystem::temp_directory_path() / "render_bench_XXXXXX";
  if (!mkdtemp(folder.data())) return 1;
  if (figure.empty()) figure = make_figure(folder);
  objdb::Database world;
  std::string problem = figure.empty() ? "the dialog manager made no figure; build it, or give --figure" : "";
  if (problem.empty()) problem = declare_types(declaration, world);
  if (problem.empty()) problem = read_world(figure, world);
  if (!problem.empty()) {
    std::fprintf(stderr, "render_bench: %s\n", problem.c_str());
    return 1;
  }
  Stage stage;
  const Scene sailor = stage.compose(world, nullptr, 0);
  measure("one sailor", sailor, 3.4f, rounds, folder, !without_vtk);

  // ten of them, five a row
  Scene ten = sailor;
  ten.drawables.clear();
  for (int i = 0; i < 10; ++i) {
    for (Drawable drawable : sailor.drawables) {
      drawable.X_WG.pretranslate(Eigen::Vector3f(static_cast<float>(i % 5) * 0.9f - 1.8f, 0, i < 5 ? 0.0f : -1.2f));
      ten.drawables.push_back(drawable);
    }
  }
  measure("ten sailors", ten, 6.5f, rounds, folder, !without_vtk);
  measure_moving(world, rounds);
  std::fflush(stdout);
  const std::string latency =
      "/usr/bin/python3 " + std::string(SOURCE_DIR) + "/tests/bench/render_latency.py " + BIN_DIR;
  if (std::system(latency.c_str()) != 0) std::printf("latency: not measured\n");
  std::filesystem::remove_all(folder);
  return 0;
}
