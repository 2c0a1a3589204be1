#include "manipulators/render/views.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "manipulators/render/elements.h"
#include "manipulators/render/look.h"
#include "manipulators/render/shapes.h"
#include "manipulators/render/stage.h"
#include "objdb/scene/scene.h"
#include "objdb/statement.h"

namespace render {

using objdb::Database;
using objdb::Object;

namespace {

using Color = std::array<std::uint8_t, 4>;

constexpr Color red = {222, 62, 52, 255};
constexpr Color green = {74, 178, 92, 255};
constexpr Color blue = {66, 116, 214, 255};

Drawable helper(GeometryPointer geometry, const Eigen::Vector3f& color = Eigen::Vector3f::Ones()) {
  Drawable drawable;
  drawable.geometry = std::move(geometry);
  drawable.materials[0].color = color;
  drawable.helper = true;
  drawable.casts_shadow = false;
  return drawable;
}

void add_lines(const std::vector<Eigen::Vector3f>& points, const std::vector<Color>& colors, float width, bool on_top,
               Scene& scene) {
  if (points.empty()) return;
  Drawable lines = helper(segments(points, colors));
  lines.materials[0].finish = Finish::unlit;
  lines.line_width = width;
  lines.on_top = on_top;
  scene.drawables.push_back(std::move(lines));
}

// the frame in which a joint turns about z, before it turns: angle 0 points along x
Eigen::Isometry3d base_of(const Database& world, const Object& joint) {
  Eigen::Isometry3d X_W = Eigen::Isometry3d::Identity();
  if (const Object* parent = world.object(world.scene().parent_of(joint))) X_W = frame_of(world, *parent);
  X_W.translate(vector_of(joint, "position").cast<double>());
  X_W.rotate(turn_of(joint, "orientation"));
  const objdb::Numbers* dh = numbers_of(joint, "dh");
  X_W.rotate(Eigen::AngleAxisd(dh && !dh->empty() ? (*dh)[0] : 0, Eigen::Vector3d::UnitZ()));
  return X_W;
}

// how large signs at a joint are drawn [m]: a share of the way to the next joint
double size_of(const Database& world, const Object& joint) {
  double longest = 0;
  for (objdb::ObjectId id : joint.place->children) {
    if (const Object* child = world.object(id)) {
      longest = std::max(longest, (frame_of(world, *child).translation() - base_of(world, joint).translation()).norm());
    }
  }
  return std::clamp(longest * 0.35, 0.03, 0.12);
}

}  // namespace

void add_bones(const Database& world, Scene& scene) {
  static const GeometryPointer spindle = tube({{0, 0, 0}, {0, 0.12f, 0}, {0, 1, 0}}, {0.015f, 0.075f, 0.012f}, {}, 6);
  auto add_spindle = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3f& color) {
    const Eigen::Vector3f along = (to - from).cast<float>();
    if (along.norm() < 1e-3f) return;
    Drawable bone = helper(spindle, color);
    bone.on_top = true;
    bone.X_WG.translate(from.cast<float>());
    bone.X_WG.rotate(Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitY(), along));
    bone.X_WG.scale(along.norm());
    scene.drawables.push_back(std::move(bone));
  };

  std::vector<Eigen::Vector3f> points;
  std::vector<Color> colors;
  for (const Object* joint : all_of(world, "joint")) {
    const Eigen::Isometry3d X_WJ = base_of(world, *joint);
    const double size = size_of(world, *joint);
    for (int axis = 0; axis < 3; ++axis) {
      points.push_back(X_WJ.translation().cast<float>());
      const double length = axis == 2 ? size : 0.4 * size;
      points.push_back((X_WJ.translation() + X_WJ.linear().col(axis) * length).cast<float>());
      const Color color = axis == 0 ? red : axis == 1 ? green : blue;
      colors.insert(colors.end(), {color, color});
    }
    for (objdb::ObjectId id : joint->place->children) {
      const Object* child = world.object(id);
      if (child && is_a(world, *child, "joint")) {
        add_spindle(X_WJ.translation(), base_of(world, *child).translation(), {0.93f, 0.88f, 0.74f});
      }
    }
  }
  for (const Object* bone : all_of(world, "bone")) {
    const Eigen::Isometry3d X_WB = frame_of(world, *bone);
    add_spindle(X_WB * vector_of(*bone, "from").cast<double>(), X_WB * vector_of(*bone, "to").cast<double>(),
                {0.85f, 0.80f, 0.68f});
  }
  add_lines(points, colors, 2.2f, true, scene);
}

void add_limits(const Database& world, Scene& scene) {
  std::vector<Eigen::Vector3f> points;
  std::vector<Color> colors;
  for (const Object* joint : all_of(world, "joint")) {
    const double lower = real_of(*joint, "lower");
    const double upper = real_of(*joint, "upper");
    const double angle = real_of(*joint, "angle");
    if (!(upper > lower)) continue;
    const double size = size_of(world, *joint);
    const Eigen::Isometry3d X_WJ = base_of(world, *joint);
    // red when it stands at its end: within one percent of its range
    const bool at_end = std::min(angle - lower, upper - angle) < 0.01 * (upper - lower);
    const double shown_upper = std::min(upper, lower + 2 * std::numbers::pi);
    Drawable range = helper(sector(static_cast<float>(lower), static_cast<float>(shown_upper)),
                            at_end ? Eigen::Vector3f(0.87f, 0.25f, 0.2f) : Eigen::Vector3f(0.25f, 0.62f, 0.85f));
    range.materials[0].opacity = 0.35f;
    range.X_WG = Eigen::Affine3f(X_WJ.cast<float>());
    range.X_WG.scale(static_cast<float>(size));
    scene.drawables.push_back(std::move(range));
    points.push_back(X_WJ.translation().cast<float>());
    points.push_back(
        (X_WJ * Eigen::Vector3d(std::cos(angle) * size * 1.1, std::sin(angle) * size * 1.1, 0)).cast<float>());
    colors.insert(colors.end(), 2, at_end ? red : Color{245, 245, 245, 255});
  }
  add_lines(points, colors, 2, false, scene);

  // ball joints: how far the direction of their z axis may swing from rest
  for (const Object* node : all_of(world, "node")) {
    const objdb::Numbers* several = numbers_of(*node, "swing_limit");
    const double one = real_of(*node, "swing_limit", -1);
    std::vector<float> angles(24, static_cast<float>(one));
    if (several && !several->empty()) {
      // two or more half angles, evenly around, joined by a cosine
      for (std::size_t k = 0; k < angles.size(); ++k) {
        const double at = static_cast<double>(k * several->size()) / static_cast<double>(angles.size());
        const auto i = static_cast<std::size_t>(at);
        const double blend = 0.5 - 0.5 * std::cos(std::numbers::pi * (at - static_cast<double>(i)));
        const double a = (*several)[i % several->size()];
        const double b = (*several)[(i + 1) % several->size()];
        angles[k] = static_cast<float>(a + blend * (b - a));
      }
    } else if (one < 0) {
      continue;
    }
    Eigen::Isometry3d X_W = Eigen::Isometry3d::Identity();
    if (const Object* parent = world.object(world.scene().parent_of(*node))) X_W = frame_of(world, *parent);
    X_W.translation() = frame_of(world, *node).translation();
    Drawable cone = helper(limit_cone(angles), {0.25f, 0.62f, 0.85f});
    cone.materials[0].opacity = 0.3f;
    cone.X_WG = Eigen::Affine3f(X_W.cast<float>());
    cone.X_WG.scale(0.2f);
    scene.drawables.push_back(std::move(cone));
  }
}

void add_gaze_rays(const Database& world, Scene& scene) {
  std::vector<const Object*> eyes = all_of(world, "eye");
  for (const Object* ball : all_of(world, "eyeball")) {
    const Object* holder = world.object(world.scene().parent_of(*ball));
    if (!holder || !is_a(world, *holder, "eye")) eyes.push_back(ball);
  }
  std::vector<Eigen::Vector3f> points;
  std::vector<Color> colors;
  for (const Object* eye : eyes) {
    if (!eye->place) continue;
    const Eigen::Isometry3d X_WE = frame_of(world, *eye);
    double length = 3;
    for (const Object* holder = eye; holder; holder = world.object(holder->parent)) {
      const Object* target = object_of(world, *holder, "target");
      if (!target || !target->place) continue;
      length = (frame_of(world, *target).translation() - X_WE.translation()).norm();
      break;
    }
    // two thirds strong, the rest fading out, so that crossing rays stay readable
    const Eigen::Vector3d forward = X_WE.linear().col(2);
    for (double along : {0.0, 1.0, 1.0, 1.15})
      points.push_back((X_WE.translation() + forward * (length * along)).cast<float>());
    colors.insert(colors.end(), {Color{255, 196, 61, 255}, Color{255, 196, 61, 255}, Color{255, 196, 61, 255},
                                 Color{255, 196, 61, 0}});
  }
  add_lines(points, colors, 2, false, scene);
}

void add_muscles(const Database& world, Scene& scene) {
  for (const auto& type : world.schema().types()) {
    if (type->find("origin") < 0 || type->find("insertion") < 0) continue;
    for (const Object* muscle : world.objects_of(*type)) {
      if (muscle->type != type.get()) continue;
      Eigen::Isometry3d X_W = Eigen::Isometry3d::Identity();
      if (muscle->place) X_W = frame_of(world, *muscle);
      const Eigen::Vector3f p0 = (X_W * vector_of(*muscle, "origin").cast<double>()).cast<float>();
      const Eigen::Vector3f p1 = (X_W * vector_of(*muscle, "insertion").cast<double>()).cast<float>();
      const auto r0 = static_cast<float>(real_of(*muscle, "origin_radius", 0.002));
      const auto r1 = static_cast<float>(real_of(*muscle, "insertion_radius", 0.004));
      // a belly between thin ends
      std::vector<Eigen::Vector3f> points;
      std::vector<float> radii;
      for (int i = 0; i <= 8; ++i) {
        const float s = static_cast<float>(i) / 8;
        points.push_back(p0 + s * (p1 - p0));
        const float belly = 0.6f + 0.4f * std::sin(s * std::numbers::pi_v<float>);
        radii.push_back(std::clamp(0.35f * (r0 + s * (r1 - r0)), 0.0006f, 0.004f) * belly);
      }
      Drawable drawable =
          helper(tube(points, radii, std::vector<Color>(points.size(), heat(real_of(*muscle, "activation")))));
      drawable.on_top = true;
      drawable.materials[0].color = {1, 1, 1};
      drawable.materials[0].roughness = 0.45f;
      scene.drawables.push_back(std::move(drawable));
    }
  }
}

void add_trails(const Database& world, const Object& view, const Trails& trails, double time, Scene& scene) {
  const double span = real_of(view, "trail_time", 2);
  for (const Object* node : objects_of(world, view, "trails")) {
    std::vector<Eigen::Vector3f> points;
    std::vector<float> radii;
    std::vector<Color> colors;
    for (const Trails::Point& point : trails.of(node->id)) {
      if (point.time < time - span) continue;
      // points that coincide would have no direction
      if (!points.empty() && (points.back() - point.position).norm() < 1e-5f) continue;
      const double age = std::clamp((time - point.time) / span, 0.0, 1.0);
      points.push_back(point.position);
      radii.push_back(static_cast<float>(0.0035 * (1 - 0.8 * age)));
      colors.push_back(heat(1 - age));
    }
    if (points.size() < 2) continue;
    Drawable trail = helper(tube(points, radii, colors, 8));
    trail.materials[0].color = {1, 1, 1};
    trail.materials[0].finish = Finish::unlit;
    scene.drawables.push_back(std::move(trail));
  }
}

void add_overlay(const Database& world, const Object& view, double time, Scene& scene) {
  const objdb::Value* value = value_of(view, "overlay");
  const auto* lines = value ? std::get_if<std::vector<std::string>>(value) : nullptr;
  if (!lines) return;
  constexpr std::size_t most_lines = 30;
  std::vector<std::string> written;
  for (const std::string& line : *lines) {
    if (line == "time") {
      char text[40];
      std::snprintf(text, sizeof text, "t = %.3f s", time);
      written.push_back(text);
      continue;
    }
    // PATTERN.FIELD of something that is there, else words
    const objdb::Word word{line, 1, false};
    auto target = objdb::parse_target(word);
    const std::size_t before = written.size();
    if (target && !target->field.empty()) {
      auto objects = objdb::find_objects(world, target->pattern, 1, {});
      for (const Object* object : objects ? *objects : std::vector<const Object*>()) {
        auto field = objdb::find_field(*object, target->field, 1);
        if (!field) continue;
        std::string text = object->path + "." + std::string(target->field) + " ";
        objdb::append_value(text, object->type->field(*field), world.value(*object, *field), world);
        if (text.size() > 110) text = text.substr(0, 107) + "...";
        written.push_back(text);
      }
    }
    if (written.size() == before) written.push_back(line);
  }
  if (written.size() > most_lines) {
    written[most_lines - 1] = "... and " + std::to_string(written.size() - most_lines + 1) + " more";
    written.resize(most_lines);
  }
  float y = 14;
  for (std::string& line : written) {
    scene.labels.push_back({std::move(line), 16, y});
    y += 21;
  }
}

void add_views(const Database& world, const Object& view, const Trails& trails, double time, Scene& scene) {
  if (flag_of(view, "bones")) add_bones(world, scene);
  if (flag_of(view, "limits")) add_limits(world, scene);
  if (flag_of(view, "gaze_rays")) add_gaze_rays(world, scene);
  if (flag_of(view, "muscles")) add_muscles(world, scene);
  add_elements(world, view, scene);
  add_trails(world, view, trails, time, scene);
  add_overlay(world, view, time, scene);
}

}  // namespace render
