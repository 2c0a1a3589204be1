#include "manipulators/render/skins.h"

#include <algorithm>
#include <numeric>

#include "manipulators/mesh/dress.h"
#include "manipulators/mesh/find.h"
#include "manipulators/mesh/normals.h"
#include "manipulators/mesh/read.h"
#include "manipulators/mesh/stand_in.h"
#include "manipulators/render/look.h"
#include "manipulators/render/shapes.h"

namespace render {

using objdb::Object;
using objdb::ObjectId;

namespace {

void copy_vertices(const Eigen::MatrixX3f& V, const Eigen::MatrixX3f& N, Geometry& geometry) {
  for (std::size_t v = 0; v < geometry.vertices.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    geometry.vertices[v].position = V.row(row);
    geometry.vertices[v].normal = N.row(row);
  }
  geometry.touch();
}

bool has_face(const objdb::Database& world, const Object& surface) {
  const std::vector<const Object*> faces = all_of(world, "face");
  return std::any_of(faces.begin(), faces.end(),
                     [&](const Object* face) { return object_of(world, *face, "skin") == &surface; });
}

mesh::Bone bone_from(const objdb::Database& world, const Object& object, const std::vector<ObjectId>& order) {
  mesh::Bone bone;
  bone.name = std::string(object.name());
  bone.bind.linear() = turn_of(object, "bind_orientation").toRotationMatrix();
  bone.bind.translation() = vector_of(object, "bind_position").cast<double>();
  bone.from = vector_of(object, "from").cast<double>();
  bone.to = vector_of(object, "to").cast<double>();
  bone.radius = real_of(object, "radius", 0.05);
  bone.twist = real_of(object, "twist", 1);
  if (const Object* source = object_of(world, object, "twist_from")) {
    const auto found = std::find(order.begin(), order.end(), source->id);
    if (found != order.end()) bone.twist_from = static_cast<int>(found - order.begin());
  }
  return bone;
}

// rows of four numbers; what is left over is dropped
Eigen::MatrixX4d rows_of_four(const Object& object, std::string_view field) {
  const objdb::Numbers* numbers = numbers_of(object, field);
  const Eigen::Index rows = numbers ? static_cast<Eigen::Index>(numbers->size() / 4) : 0;
  Eigen::MatrixX4d matrix(rows, 4);
  for (Eigen::Index r = 0; r < rows; ++r) {
    for (Eigen::Index c = 0; c < 4; ++c) matrix(r, c) = (*numbers)[static_cast<std::size_t>(4 * r + c)];
  }
  return matrix;
}

// the objects of a type that belong to this skin, in order of path
std::vector<const Object*> bones_of(const objdb::Database& world, const Object& skin) {
  std::vector<const Object*> bones;
  const Object* skeleton = object_of(world, skin, "skeleton");
  if (!skeleton) return bones;
  const std::string prefix = skeleton->path + "/";
  for (const Object* bone : all_of(world, "bone")) {
    if (bone->path.starts_with(prefix)) bones.push_back(bone);
  }
  std::sort(bones.begin(), bones.end(), [](const Object* a, const Object* b) { return a->path < b->path; });
  return bones;
}

std::vector<const Object*> garments_of(const objdb::Database& world, const Object& skin) {
  std::vector<const Object*> garments;
  for (const Object* garment : all_of(world, "garment")) {
    if (object_of(world, *garment, "skin") == &skin) garments.push_back(garment);
  }
  std::sort(garments.begin(), garments.end(), [](const Object* a, const Object* b) {
    const auto la = integer_of(*a, "layer");
    const auto lb = integer_of(*b, "layer");
    return la != lb ? la < lb : a->path < b->path;
  });
  return garments;
}

Material look_of_garment(const Object& garment) {
  Material material;
  material.color = vector_of(garment, "color", {0.8f, 0.8f, 0.8f});
  const double gloss = real_of(garment, "gloss", 0.1);
  material.roughness = static_cast<float>(1 - 0.85 * gloss);
  // wool glows at its edge, leather does not
  material.sheen = static_cast<float>(std::max(0.0, 0.45 - gloss));
  return material;
}

}  // namespace

std::shared_ptr<Geometry> geometry_of(const mesh::Surface& surface) {
  auto geometry = std::make_shared<Geometry>();
  geometry->vertices.resize(static_cast<std::size_t>(surface.V.rows()));
  const Eigen::MatrixX3f N =
      surface.N.rows() == surface.V.rows() ? surface.N : mesh::vertex_normals(surface.V, surface.F);

  // faces sorted by part, so that each part is one run
  Level& level = geometry->levels[0];
  const std::size_t parts = std::max<std::size_t>(1, surface.part_names.size());
  std::vector<std::vector<Eigen::Index>> faces(parts);
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    faces[surface.part.empty() ? 0 : static_cast<std::size_t>(surface.part[static_cast<std::size_t>(f)])].push_back(f);
  }
  for (std::size_t part = 0; part < parts; ++part) {
    const auto first = static_cast<std::uint32_t>(level.indices.size());
    for (Eigen::Index f : faces[part]) {
      for (int k = 0; k < 3; ++k) level.indices.push_back(static_cast<std::uint32_t>(surface.F(f, k)));
    }
    level.spans.push_back({first, static_cast<std::uint32_t>(level.indices.size()) - first, static_cast<int>(part)});
  }
  copy_vertices(surface.V, N, *geometry);
  add_levels(*geometry);
  return geometry;
}

Material usual_look(const std::string& part, const Material& otherwise) {
  struct Usual {
    const char* word;
    Eigen::Vector3f color;
    float roughness;
    Finish finish;
  };
  static const Usual table[] = {
      {"lips", {0.70f, 0.38f, 0.36f}, 0.45f, Finish::skin},  {"lashes", {0.10f, 0.07f, 0.05f}, 0.8f, Finish::plain},
      {"brow", {0.24f, 0.16f, 0.10f}, 0.9f, Finish::plain},  {"hair", {0.24f, 0.16f, 0.10f}, 0.7f, Finish::plain},
      {"teeth", {0.92f, 0.90f, 0.84f}, 0.3f, Finish::plain}, {"tongue", {0.68f, 0.34f, 0.34f}, 0.5f, Finish::skin},
      {"eyes", {0.90f, 0.88f, 0.86f}, 0.25f, Finish::plain}, {"nail", {0.86f, 0.66f, 0.60f}, 0.35f, Finish::skin},
  };
  for (const Usual& usual : table) {
    if (part.find(usual.word) == std::string::npos) continue;
    Material material;
    material.color = usual.color;
    material.roughness = usual.roughness;
    material.finish = usual.finish;
    return material;
  }
  return otherwise;
}

std::shared_ptr<const Geometry> Skins::mesh(const objdb::Database& world, const Object& object, Report& report,
                                            std::vector<std::string>& parts) {
  const std::string name = text_of(object, "file");
  report.object = object.id;
  if (name.empty()) {
    report.status = "none";
    report.reason = "file is empty";
    return nullptr;
  }
  auto [entry, is_new] = files_.try_emplace(name);
  File& file = entry->second;
  if (is_new) {
    auto path = mesh::find_file(name);
    auto surface = path ? mesh::read_surface(*path) : mesh::Result<mesh::Surface>(path.error());
    if (surface) {
      file.geometry = geometry_of(*surface);
      file.parts = surface->part_names;
      file.origin = mesh::own_origin(surface->V.rows());
      file.V = std::move(surface->V);
      file.F = std::move(surface->F);
    } else {
      file.report.status = "failed";
      file.report.reason = surface.error().sentence;
    }
  }
  report.status = file.report.status;
  report.reason = file.report.reason;
  parts = file.parts;
  if (!file.geometry || !has_face(world, object)) {
    moved_.erase(object.id);
    return file.geometry;
  }

  Moved& moved = moved_[object.id];
  if (moved.file != name) moved = {name, {}, nullptr};
  const Faces::Change change = moved.faces.look(world, object, file.origin);
  if (report.reason.empty()) report.reason = moved.faces.problem();
  if (moved.geometry && change == Faces::Change::none) return moved.geometry;
  Eigen::MatrixX3f V = file.V;
  moved.faces.add(V);
  if (!moved.geometry) {
    // a geometry of its own, the file's may be shown elsewhere
    moved.geometry = std::make_shared<Geometry>(*file.geometry);
    moved.geometry->id = Geometry().id;
  } else if (moved.geometry.use_count() > 1) {
    // a window may still be drawing the last shape: leave it that one
    moved.geometry = std::make_shared<Geometry>(*moved.geometry);
  }
  copy_vertices(V, mesh::vertex_normals(V, file.F), *moved.geometry);
  return moved.geometry;
}

void Skins::bind(const objdb::Database& world, const Object& object, Body& body) {
  body.geometry = nullptr;
  body.pose.clear();
  body.faces = {};
  body.patch = {};
  body.rest.resize(0, 3);
  body.report.status = "ok";
  body.report.reason.clear();
  body.bones.clear();
  const std::vector<const Object*> objects = bones_of(world, object);
  for (const Object* bone : objects) body.bones.push_back(bone->id);
  if (objects.empty()) {
    body.report.status = "none";
    body.report.reason =
        object_of(world, object, "skeleton") ? "no object of type bone is below its skeleton" : "it has no skeleton";
    return;
  }
  std::vector<mesh::Bone> bones;
  for (const Object* bone : objects) bones.push_back(bone_from(world, *bone, body.bones));

  // without the body's file a figure of capsules stands in; a broken file is the user's to mend
  const std::string name = text_of(object, "file");
  auto path = mesh::find_file(name);
  auto surface = path ? mesh::read_surface(*path) : mesh::Result<mesh::Surface>(path.error());
  mesh::Skin skin;
  if (surface) {
    auto bound = mesh::bind_skin(std::move(*surface), bones);
    if (!bound) {
      body.report.status = "failed";
      body.report.reason = bound.error().sentence;
      return;
    }
    skin = std::move(*bound);
  } else {
    body.report.status = surface.error().kind == "io" ? "stand_in" : "failed";
    body.report.reason = surface.error().sentence;
    skin = mesh::stand_in(bones);
  }

  std::vector<mesh::Garment> garments;
  for (const Object* object_of_garment : garments_of(world, object)) {
    mesh::Garment garment;
    garment.name = std::string(object_of_garment->name());
    for (const Object* bone : objects_of(world, *object_of_garment, "bones")) {
      const auto found = std::find(body.bones.begin(), body.bones.end(), bone->id);
      if (found != body.bones.end()) garment.bones.push_back(static_cast<int>(found - body.bones.begin()));
    }
    garment.planes = rows_of_four(*object_of_garment, "planes");
    garment.lines = rows_of_four(*object_of_garment, "lines");
    garment.thickness = real_of(*object_of_garment, "thickness");
    garment.smoothing = static_cast<int>(integer_of(*object_of_garment, "smoothing"));
    const objdb::Numbers* flare = numbers_of(*object_of_garment, "flare");
    if (flare && flare->size() == 4) garment.flare = Eigen::Map<const Eigen::Vector4d>(flare->data());
    garments.push_back(std::move(garment));
  }
  if (auto dressed = mesh::dress(skin, garments)) {
    body.skin = std::move(*dressed);
  } else {
    body.skin = std::move(skin);
    body.report.reason = dressed.error().sentence;
  }
  body.geometry = geometry_of(body.skin.surface);
  // a body is seen from outside only; the edges of its clothes are closed
  body.geometry->closed = true;
}

std::shared_ptr<const Geometry> Skins::skin(const objdb::Database& world, const Object& object, Report& report,
                                            std::vector<Material>& materials) {
  Body& body = bodies_[object.id];
  const std::vector<const Object*> garments = garments_of(world, object);
  std::uint64_t made_of = hash_of(object, {"file", "skeleton"});
  for (const Object* bone : bones_of(world, object)) {
    made_of = objdb::hash_word(
        made_of, hash_of(*bone, {"from", "to", "radius", "bind_position", "bind_orientation", "twist_from", "twist"}));
  }
  for (const Object* garment : garments) {
    made_of =
        objdb::hash_word(made_of, hash_of(*garment, {"bones", "planes", "lines", "thickness", "flare", "smoothing"}));
  }
  if (!body.made || made_of != body.made_of) {
    body.made = true;
    body.made_of = made_of;
    body.report.object = object.id;
    bind(world, object, body);
  }
  report = body.report;
  if (!body.geometry) return nullptr;

  // bare skin wears the skin's own colour; each garment its own
  Material bare;
  bare.color = vector_of(object, "color", {0.8f, 0.6f, 0.5f});
  bare.roughness = static_cast<float>(1 - 0.85 * real_of(object, "shininess", 0.5));
  bare.opacity = static_cast<float>(real_of(object, "opacity", 1));
  bare.finish = Finish::skin;
  materials.clear();
  const bool has_eyes = !all_of(world, "eye").empty() || !all_of(world, "eyeball").empty();
  for (const std::string& part : body.skin.surface.part_names) {
    const auto garment =
        std::find_if(garments.begin(), garments.end(), [&](const Object* g) { return g->name() == part; });
    materials.push_back(garment == garments.end() ? usual_look(part, bare) : look_of_garment(**garment));
    // the file's own eyeballs give way to ours
    materials.back().opacity = has_eyes && part.find("eyes") != std::string::npos ? 0 : bare.opacity;
  }

  pose(world, object, body);
  if (report.reason.empty()) report.reason = body.faces.problem();
  return body.geometry;
}

void Skins::pose(const objdb::Database& world, const Object& object, Body& body) {
  // a stand-in has none of the file's vertices for a face to move
  Faces::Change change = Faces::Change::none;
  if (body.skin.origin.older > 0) change = body.faces.look(world, object, body.skin.origin);
  if (change == Faces::Change::others) {
    body.patch = mesh::patch_around(body.skin.surface.F, body.skin.weld, body.faces.vertices());
  }
  if (change != Faces::Change::none || body.rest.rows() != body.skin.surface.V.rows()) {
    body.rest = body.skin.surface.V;
    body.faces.add(body.rest);
  }

  std::vector<Eigen::Isometry3d> pose;
  for (ObjectId id : body.bones) pose.push_back(frame_of(world, *world.object(id)));
  const auto blend = word_of(object, "blend") == "linear" ? mesh::Blend::linear : mesh::Blend::dual_quaternion;
  const bool moved = change == Faces::Change::others || pose.size() != body.pose.size() || blend != body.blend ||
                     !std::equal(pose.begin(), pose.end(), body.pose.begin(),
                                 [](const auto& a, const auto& b) { return a.matrix() == b.matrix(); });
  if (!moved && change == Faces::Change::none) return;
  if (moved) {
    mesh::deform(body.skin, body.rest, pose, body.V, body.N, blend);
  } else {
    mesh::deform_patch(body.skin, body.rest, pose, body.patch, body.V, body.N, blend);
  }
  // a window may still be drawing the last pose: leave it that one
  if (body.geometry.use_count() > 1) body.geometry = std::make_shared<Geometry>(*body.geometry);
  copy_vertices(body.V, body.N, *body.geometry);
  body.pose = std::move(pose);
  body.blend = blend;
}

std::shared_ptr<const Geometry> Skins::carried(const Object& object, Report& report) {
  Carried& kept = carried_[object.id];
  const std::uint64_t triangles = hash_of(object, {"triangles"});
  const std::uint64_t vertices = hash_of(object, {"vertices"});
  report = kept.report;
  if (kept.triangles == triangles && kept.vertices == vertices) return kept.geometry;
  const bool same_triangles = kept.geometry && kept.triangles == triangles;
  kept.triangles = triangles;
  kept.vertices = vertices;
  kept.report = {object.id, "ok", ""};

  const objdb::Numbers* points = numbers_of(object, "vertices");
  const std::span<const double> numbers = points ? points->span() : std::span<const double>();
  const objdb::Value* value = value_of(object, "triangles");
  const auto* corners = value ? std::get_if<std::vector<std::int64_t>>(value) : nullptr;
  const std::size_t count = numbers.size() / 3;
  const bool fits =
      corners && !corners->empty() && std::all_of(corners->begin(), corners->end(), [&](std::int64_t corner) {
        return corner >= 0 && corner < static_cast<std::int64_t>(count);
      });
  if (!fits) {
    kept.geometry = nullptr;
    kept.report.status = count == 0 && (!corners || corners->empty()) ? "none" : "failed";
    kept.report.reason = kept.report.status == "none"
                             ? "it has no vertices yet"
                             : "a triangle names a vertex that is not among its " + std::to_string(count);
    report = kept.report;
    return nullptr;
  }
  // a window may still be drawing the last shape; new triangles make a new geometry
  auto geometry = same_triangles && kept.geometry->vertices.size() == count
                      ? (kept.geometry.use_count() > 1 ? std::make_shared<Geometry>(*kept.geometry) : kept.geometry)
                      : std::make_shared<Geometry>();
  geometry->vertices.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    geometry->vertices[v].position =
        Eigen::Vector3d(numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]).cast<float>();
  }
  if (geometry->levels[0].indices.empty()) {
    geometry->levels[0].indices.assign(corners->begin(),
                                       corners->begin() + static_cast<std::ptrdiff_t>(corners->size() / 3 * 3));
    geometry->close();
  }
  recompute_normals(*geometry);
  geometry->touch();
  kept.geometry = geometry;
  report = kept.report;
  return geometry;
}

const mesh::Skin* Skins::bound(ObjectId skin) const {
  const auto found = bodies_.find(skin);
  return found == bodies_.end() || !found->second.geometry ? nullptr : &found->second.skin;
}

const Eigen::MatrixX3f& Skins::rest(ObjectId skin) const { return bodies_.at(skin).rest; }

Eigen::AlignedBox3f Skins::moved_box(ObjectId surface) const {
  Eigen::AlignedBox3f box;
  const auto body = bodies_.find(surface);
  if (body == bodies_.end() || !body->second.geometry) return box;
  for (int v : body->second.patch.moved) box.extend(Eigen::Vector3f(body->second.V.row(v)));
  return box;
}

const std::vector<ObjectId>& Skins::bones(ObjectId skin) const {
  static const std::vector<ObjectId> none;
  const auto found = bodies_.find(skin);
  return found == bodies_.end() ? none : found->second.bones;
}

}  // namespace render
