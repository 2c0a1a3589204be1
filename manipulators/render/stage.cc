#include "manipulators/render/stage.h"

#include <algorithm>
#include <cmath>

#include "manipulators/render/look.h"
#include "manipulators/render/pick.h"
#include "manipulators/render/shapes.h"
#include "manipulators/render/views.h"

namespace render {

using objdb::Database;
using objdb::Object;
using objdb::ObjectId;

namespace {

Material look_of_shape(const Object& object) {
  Material material;
  material.color = vector_of(object, "color", material.color);
  material.opacity = static_cast<float>(real_of(object, "opacity", 1));
  material.roughness = static_cast<float>(1 - 0.85 * real_of(object, "shininess", 0.2));
  return material;
}

// a `material` below the mesh under the part's name, else what the name suggests
Material look_of_part(const Database& world, const Object& mesh, const std::string& part, const Material& otherwise) {
  const Object* object = world.find(mesh.path + "/" + part);
  if (!object || !is_a(world, *object, "material")) return usual_look(part, otherwise);
  Material material = look_of_shape(*object);
  const std::string_view finish = word_of(*object, "finish");
  if (finish == "skin") material.finish = Finish::skin;
  if (finish == "cloth") material.sheen = 0.4f;
  return material;
}

Eigen::Affine3f placed(const Database& world, const Object& object, const Eigen::Vector3f& size) {
  Eigen::Affine3f X_WG(frame_of(world, object).cast<float>());
  const Eigen::Vector3f scale = vector_of(object, "scale", Eigen::Vector3f::Ones());
  X_WG.scale(Eigen::Vector3f(scale.cwiseProduct(size)));
  return X_WG;
}

// larger than this is scenery: it does not decide where shadows are sharp, nor what a camera frames by itself
constexpr float scenery_size = 4;  // [m]

}  // namespace

// ---- trails

void Trails::record(const Database& world, double time) {
  std::map<ObjectId, double> wanted;
  for (const Object* view : all_of(world, "view")) {
    for (const Object* node : objects_of(world, *view, "trails")) {
      double& span = wanted[node->id];
      span = std::max(span, real_of(*view, "trail_time", 2));
    }
  }
  std::erase_if(ways_, [&](const auto& way) { return !wanted.contains(way.first); });
  for (const auto& [id, span] : wanted) {
    std::deque<Point>& way = ways_[id];
    if (!way.empty() && time < way.back().time) way.clear();
    if (!way.empty() && time == way.back().time) way.pop_back();
    way.push_back({time, frame_of(world, *world.object(id)).translation().cast<float>()});
    while (way.front().time < time - span) way.pop_front();
  }
}

const std::deque<Trails::Point>& Trails::of(ObjectId node) const {
  static const std::deque<Point> none;
  const auto found = ways_.find(node);
  return found == ways_.end() ? none : found->second;
}

// ---- stage

bool Stage::visible(const Database& world, const Object& node) {
  if (visible_.size() <= node.id) visible_.resize(node.id + 1, 0);
  signed char& known = visible_[node.id];
  if (known != 0) return known > 0;
  bool is_visible = flag_of(node, "visible", true);
  const Object* parent = node.place ? world.object(world.scene().parent_of(node)) : nullptr;
  if (is_visible && parent) is_visible = visible(world, *parent);
  visible_[node.id] = is_visible ? 1 : -1;
  return is_visible;
}

GeometryPointer Stage::capsule_of(const Object& object) {
  const double radius = real_of(object, "radius");
  const double length = real_of(object, "length");
  GeometryPointer& geometry = capsules_[{radius, length}];
  if (!geometry) geometry = capsule(static_cast<float>(radius), static_cast<float>(length));
  return geometry;
}

void Stage::add_shape(const Database& world, const Object& object, float skin_opacity, Scene& scene) {
  Drawable drawable;
  drawable.path = object.path;
  drawable.materials = {look_of_shape(object)};
  Eigen::Vector3f size = Eigen::Vector3f::Ones();
  const auto radius = static_cast<float>(real_of(object, "radius"));
  const auto length = static_cast<float>(real_of(object, "length"));

  if (is_a(world, object, "eyeball")) {
    add_eyeball(world, object, scene);
    return;
  }
  if (is_a(world, object, "skin")) {
    Report report;
    drawable.geometry = skins_.skin(world, object, report, drawable.materials);
    reports_.push_back(report);
    for (Material& material : drawable.materials) material.opacity *= skin_opacity;
    if (!drawable.geometry) return;
    scene.drawables.push_back(std::move(drawable));
    return;
  }
  if (is_a(world, object, "mesh")) {
    Report report;
    std::vector<std::string> parts;
    drawable.geometry = skins_.mesh(world, object, report, parts);
    reports_.push_back(report);
    const Material own = drawable.materials[0];
    drawable.materials.clear();
    for (const std::string& part : parts) drawable.materials.push_back(look_of_part(world, object, part, own));
  } else if (is_a(world, object, "sphere")) {
    drawable.geometry = unit_sphere();
    size.setConstant(radius);
  } else if (is_a(world, object, "box")) {
    drawable.geometry = unit_box();
    size = vector_of(object, "size");
  } else if (is_a(world, object, "cylinder")) {
    drawable.geometry = unit_cylinder();
    size = {radius, length, radius};
  } else if (is_a(world, object, "capsule")) {
    drawable.geometry = capsule_of(object);
  }
  // shapes of programs that are not running are not known here
  if (!drawable.geometry || drawable.materials.empty()) return;
  drawable.X_WG = placed(world, object, size);
  drawable.scenery = world_bounds(drawable).sizes().maxCoeff() > scenery_size;
  scene.drawables.push_back(std::move(drawable));
}

void Stage::add_eyeball(const Database& world, const Object& object, Scene& scene) {
  const auto radius = std::max(1e-4f, static_cast<float>(real_of(object, "radius", 0.012)));
  auto half_angle = [&](std::string_view field, double otherwise) {
    return std::asin(std::clamp(static_cast<float>(real_of(object, field, otherwise)) / radius, 0.0f, 0.98f));
  };
  Drawable ball;
  ball.path = object.path;
  ball.geometry = unit_sphere();
  ball.X_WG = placed(world, object, Eigen::Vector3f::Constant(radius));
  ball.materials[0].finish = Finish::eye;
  ball.materials[0].color = vector_of(object, "iris_color", {0.27f, 0.42f, 0.55f});
  ball.materials[0].iris = half_angle("iris", 0.0059);
  ball.materials[0].pupil = half_angle("pupil", 0.0018);
  const Eigen::Vector3f centre = ball.X_WG.translation();
  scene.drawables.push_back(std::move(ball));
  if (!flag_of(object, "lids")) return;

  // lids are half shells through the corners of the eye; they stand still while the ball turns
  const Object* socket = &object;
  for (const Object* up = world.object(world.scene().parent_of(object)); up && up->place;
       up = world.object(world.scene().parent_of(*up))) {
    const bool turns_with_the_eye = is_a(world, *socket, "eye") || socket == &object;
    if (!turns_with_the_eye) break;
    socket = up;
  }
  static const GeometryPointer shell = sphere_cap(std::numbers::pi_v<float> / 2);
  const Eigen::Matrix3f R_WS = frame_of(world, *socket).linear().cast<float>();
  for (bool upper : {true, false}) {
    const auto edge = static_cast<float>(real_of(object, upper ? "upper_lid" : "lower_lid"));
    const Eigen::Vector3f pole = upper ? Eigen::Vector3f(0, std::cos(edge), -std::sin(edge))
                                       : Eigen::Vector3f(0, -std::cos(edge), std::sin(edge));
    Drawable lid;
    lid.path = object.path;
    lid.geometry = shell;
    lid.materials[0] = look_of_shape(object);
    lid.materials[0].finish = Finish::skin;
    lid.X_WG.translate(centre);
    lid.X_WG.rotate(R_WS * Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitZ(), pole).toRotationMatrix());
    lid.X_WG.scale(radius * (upper ? 1.08f : 1.06f));
    scene.drawables.push_back(std::move(lid));
  }
}

void Stage::add_carried(const Database& world, Scene& scene) {
  for (const auto& type : world.schema().types()) {
    if (type->find("vertices") < 0 || type->find("triangles") < 0) continue;
    for (const Object* object : world.objects_of(*type)) {
      if (object->type != type.get() || !object->place || !visible(world, *object)) continue;
      Report report;
      Drawable drawable;
      drawable.geometry = skins_.carried(*object, report);
      if (!drawable.geometry) continue;
      drawable.path = object->path;
      drawable.materials = {look_of_shape(*object)};
      drawable.materials[0].finish = Finish::skin;
      drawable.X_WG = placed(world, *object, Eigen::Vector3f::Ones());
      scene.drawables.push_back(std::move(drawable));
    }
  }
}

void Stage::add_lights(const Database& world, Scene& scene) {
  // 1 lights white paper fully once exposed
  constexpr float full = 2.1f;
  std::vector<Light> shadowless;
  int lamps = 0;
  bool has_ambient = false;
  for (const Object* object : all_of(world, "light")) {
    if (!visible(world, *object)) continue;
    const auto intensity = static_cast<float>(real_of(*object, "intensity", 1));
    const Eigen::Vector3f color = linear_of(vector_of(*object, "color", Eigen::Vector3f::Ones()));
    const Eigen::Isometry3f X_W = frame_of(world, *object).cast<float>();
    const std::string_view kind = word_of(*object, "kind", "sun");
    if (kind == "ambient") {
      scene.surroundings.ambient = intensity;
      has_ambient = true;
      continue;
    }
    ++lamps;
    Light light;
    light.distant = kind != "point";
    light.toward = light.distant ? Eigen::Vector3f(-X_W.linear().col(2)) : Eigen::Vector3f(X_W.translation());
    // a sun that was put somewhere and not turned shines from there to the origin
    const bool turned = !X_W.linear().isIdentity(1e-6f);
    if (light.distant && !turned && X_W.translation().norm() > 1e-3f) light.toward = X_W.translation().normalized();
    light.color = color * (intensity * full);
    (flag_of(*object, "shadows", true) && scene.lights.empty() ? scene.lights : shadowless).push_back(light);
  }
  if (lamps == 0 && !has_ambient) {
    scene.lights = three_point_lights();
    return;
  }
  // the first place throws shadows; if no lamp may, an unlit one takes it
  if (scene.lights.empty() && !shadowless.empty())
    scene.lights.push_back({Eigen::Vector3f::UnitY(), true, Eigen::Vector3f::Zero()});
  scene.lights.insert(scene.lights.end(), shadowless.begin(), shadowless.end());
  // a single lamp and nothing said about the rest: the usual fill and rim help it
  if (lamps == 1 && !has_ambient) {
    const std::vector<Light> usual = three_point_lights();
    scene.lights.insert(scene.lights.end(), usual.begin() + 1, usual.end());
  }
}

Scene Stage::compose(const Database& world, const Object* view, double time) {
  Scene scene;
  reports_.clear();
  visible_.assign(visible_.size(), 0);
  scene.surroundings.time = static_cast<float>(time);
  float skin_opacity = 1;
  if (view) {
    Surroundings& around = scene.surroundings;
    const std::string_view ground = word_of(*view, "ground", "studio");
    around.ground = ground == "none"   ? Ground::none
                    : ground == "grid" ? Ground::grid
                    : ground == "sea"  ? Ground::sea
                                       : Ground::studio;
    around.ground_height = static_cast<float>(real_of(*view, "ground_height"));
    around.zenith = vector_of(*view, "zenith", around.zenith);
    around.horizon = vector_of(*view, "horizon", around.horizon);
    skin_opacity = static_cast<float>(real_of(*view, "skin_opacity", 1));
  }
  add_lights(world, scene);
  for (const Object* object : all_of(world, "shape")) {
    if (visible(world, *object)) add_shape(world, *object, skin_opacity, scene);
  }
  add_carried(world, scene);
  // eyes that nobody gave a ball get a usual one
  std::vector<ObjectId> dressed;
  for (const Object* ball : all_of(world, "eyeball")) dressed.push_back(world.scene().parent_of(*ball));
  for (const Object* eye : all_of(world, "eye")) {
    if (eye->place && visible(world, *eye) && std::find(dressed.begin(), dressed.end(), eye->id) == dressed.end()) {
      add_eyeball(world, *eye, scene);
    }
  }
  if (view) add_views(world, *view, trails_, time, scene);
  return scene;
}

// ---- cameras

Camera camera_of(const Database& world, const Object& object) {
  Camera camera;
  camera.X_WC = frame_of(world, object).cast<float>();
  camera.field_of_view = static_cast<float>(real_of(object, "field_of_view", camera.field_of_view));
  camera.near = static_cast<float>(real_of(object, "near", camera.near));
  camera.far = std::max(static_cast<float>(real_of(object, "far", camera.far)), camera.near * 1.01f);
  const Object* target = object_of(world, object, "target");
  if (target && target != &object) {
    camera.X_WC = looking_at(camera.X_WC.translation(), frame_of(world, *target).translation().cast<float>());
  }
  return camera;
}

Camera camera_for(const Scene& scene, float aspect) {
  Eigen::AlignedBox3f all;
  for (const Drawable& drawable : scene.drawables) {
    if (!drawable.scenery && !drawable.helper) all.extend(world_bounds(drawable));
  }
  if (all.isEmpty()) {
    for (const Drawable& drawable : scene.drawables) all.extend(world_bounds(drawable));
  }
  if (all.isEmpty()) all.extend(Eigen::AlignedBox3f(Eigen::Vector3f(-1, 0, -1), Eigen::Vector3f(1, 2, 1)));
  Camera camera;
  camera.field_of_view = 0.6f;
  const float radius = std::max(all.diagonal().norm() / 2, 0.05f);
  const float narrow = std::min(1.0f, aspect) * std::tan(camera.field_of_view / 2);
  const float distance = radius * 1.05f * std::sqrt(1 + 1 / (narrow * narrow));
  const Eigen::Vector3f direction = Eigen::Vector3f(0.35f, 0.22f, 1).normalized();
  camera.X_WC = looking_at(all.center() + direction * distance, all.center());
  camera.near = std::max(distance - 3 * radius, distance / 200);
  camera.far = std::max(100.0f, distance + 5 * radius);
  return camera;
}

const Object* chosen_camera(const Database& world, const Object* view) {
  if (view) {
    if (const Object* camera = object_of(world, *view, "camera")) return camera;
  }
  const auto cameras = all_of(world, "camera");
  return cameras.empty() ? nullptr : cameras.front();
}

std::string solid_around(const Scene& scene, const Camera& camera) {
  const Eigen::Vector3f eye = camera.X_WC.translation();
  // a little aside, so that it does not run along the edges of bodies that stand straight before the camera
  const Eigen::Vector3f aside = camera.X_WC.linear() * Eigen::Vector3f(0.0137f, 0.0271f, 1);
  for (const Drawable& drawable : scene.drawables) {
    if (drawable.helper || !drawable.geometry->closed || !world_bounds(drawable).contains(eye)) continue;
    if (crossings(drawable, {eye, aside}) % 2 == 1) return drawable.path;
  }
  return {};
}

}  // namespace render
