#include "manipulators/render/elements.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

#include "manipulators/render/look.h"
#include "manipulators/render/shapes.h"

namespace render {

using objdb::Object;

namespace {

// corners of the six faces, counter-clockwise seen from outside
constexpr int face_corners[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

std::array<int, 4> sorted(std::array<int, 4> face) {
  std::sort(face.begin(), face.end());
  return face;
}

}  // namespace

CutAway cut_away(const ElementMesh& mesh, const Eigen::Vector4f& plane) {
  CutAway cut;
  auto edges = std::make_shared<Geometry>();
  auto faces = std::make_shared<Geometry>();
  edges->primitive = Primitive::lines;

  std::vector<bool> kept(mesh.elements.size());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    for (int node : mesh.elements[e]) centre += mesh.rest[static_cast<std::size_t>(node)] / 8;
    kept[e] = plane.head<3>().dot(centre) + plane[3] >= 0;
  }
  const bool by_element = mesh.values.size() == mesh.elements.size() && mesh.values.size() != mesh.nodes.size();
  const bool colored = by_element || mesh.values.size() == mesh.nodes.size();
  if (colored && !mesh.values.empty()) {
    const auto [low, high] = std::minmax_element(mesh.values.begin(), mesh.values.end());
    cut.low = *low;
    cut.high = *high;
  }
  const float range = cut.high > cut.low ? cut.high - cut.low : 1;

  // a face that only one kept element has is free
  std::map<std::array<int, 4>, int> owners;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (!kept[e]) continue;
    for (const auto& corners : face_corners) {
      std::array<int, 4> face;
      for (int k = 0; k < 4; ++k) face[k] = mesh.elements[e][corners[k]];
      ++owners[sorted(face)];
    }
  }
  std::set<std::pair<int, int>> drawn_edges;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (!kept[e]) continue;
    for (const auto& corners : face_corners) {
      std::array<int, 4> face;
      for (int k = 0; k < 4; ++k) face[k] = mesh.elements[e][corners[k]];
      if (owners[sorted(face)] != 1) continue;
      const auto first = static_cast<std::uint32_t>(faces->vertices.size());
      for (int node : face) {
        Vertex vertex;
        vertex.position = mesh.nodes[static_cast<std::size_t>(node)];
        if (colored) {
          const float value = mesh.values[by_element ? e : static_cast<std::size_t>(node)];
          vertex.color = heat((value - cut.low) / range);
        }
        faces->vertices.push_back(vertex);
      }
      faces->add({first, first + 1, first + 2, first, first + 2, first + 3});
      for (int k = 0; k < 4; ++k) {
        const int a = face[k];
        const int b = face[(k + 1) % 4];
        if (a == b || !drawn_edges.insert({std::min(a, b), std::max(a, b)}).second) continue;
        for (int node : {a, b}) {
          edges->levels[0].indices.push_back(static_cast<std::uint32_t>(edges->vertices.size()));
          Vertex vertex;
          vertex.position = mesh.nodes[static_cast<std::size_t>(node)];
          vertex.color = {28, 34, 44, 255};
          edges->vertices.push_back(vertex);
        }
      }
    }
  }
  faces->close();
  recompute_normals(*faces);
  edges->close();
  cut.edges = edges;
  cut.faces = faces;
  return cut;
}

namespace {

std::vector<Eigen::Vector3f> points_of(const Object& object, std::string_view field) {
  std::vector<Eigen::Vector3f> points;
  if (const objdb::Numbers* field_numbers = numbers_of(object, field)) {
    const std::span<const double> numbers = *field_numbers;
    points.reserve(numbers.size() / 3);
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
      points.push_back(Eigen::Vector3d(numbers[i], numbers[i + 1], numbers[i + 2]).cast<float>());
    }
  }
  return points;
}

// the element mesh an object carries; empty when its arrays do not fit together
ElementMesh mesh_of(const Object& object, std::string_view result) {
  ElementMesh mesh;
  mesh.rest = points_of(object, "nodes");
  mesh.nodes = mesh.rest;
  const std::vector<Eigen::Vector3f> displacement = points_of(object, "displacement");
  if (displacement.size() == mesh.nodes.size()) {
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) mesh.nodes[n] += displacement[n];
  }
  const objdb::Value* value = value_of(object, "elements");
  const auto* corners = value ? std::get_if<std::vector<std::int64_t>>(value) : nullptr;
  for (std::size_t i = 0; corners && i + 7 < corners->size(); i += 8) {
    std::array<int, 8> element;
    bool inside = true;
    for (std::size_t k = 0; k < 8; ++k) {
      const std::int64_t node = (*corners)[i + k];
      inside = inside && node >= 0 && node < static_cast<std::int64_t>(mesh.nodes.size());
      element[k] = static_cast<int>(node);
    }
    if (inside) mesh.elements.push_back(element);
  }
  if (result == "displacement") {
    for (const Eigen::Vector3f& d : displacement) mesh.values.push_back(d.norm());
  } else if (const objdb::Numbers* numbers = numbers_of(object, result)) {
    for (double number : *numbers) mesh.values.push_back(static_cast<float>(number));
  }
  return mesh;
}

}  // namespace

void add_elements(const objdb::Database& world, const Object& view, Scene& scene) {
  const std::string_view wanted = word_of(view, "elements", "none");
  if (wanted == "none") return;
  const objdb::Numbers* cut = numbers_of(view, "cut");
  Eigen::Vector4f plane(1, 0, 0, 0);
  if (cut && cut->size() == 4) plane = Eigen::Map<const Eigen::Vector4d>(cut->data()).cast<float>();

  for (const auto& type : world.schema().types()) {
    if (type->find("nodes") < 0 || type->find("elements") < 0) continue;
    for (const Object* object : world.objects_of(*type)) {
      if (object->type != type.get()) continue;
      const ElementMesh mesh = mesh_of(*object, wanted);
      if (mesh.elements.empty()) continue;
      const CutAway left = cut_away(mesh, plane);
      const Eigen::Affine3f X_W(object->place ? frame_of(world, *object).cast<float>() : Eigen::Isometry3f::Identity());
      Drawable lines;
      lines.geometry = left.edges;
      lines.materials[0].finish = Finish::unlit;
      lines.X_WG = X_W;
      lines.helper = true;
      lines.casts_shadow = false;
      lines.line_width = 1;
      scene.drawables.push_back(lines);
      if (wanted == "wireframe") continue;
      Drawable faces = lines;
      faces.geometry = left.faces;
      faces.materials[0].finish = Finish::plain;
      faces.materials[0].color = {1, 1, 1};
      scene.drawables.push_back(faces);
      if (mesh.values.empty()) continue;
      char text[120];
      std::snprintf(text, sizeof text, "%s.%s %.4g (blue) to %.4g (red)", object->path.c_str(),
                    std::string(wanted).c_str(), static_cast<double>(left.low), static_cast<double>(left.high));
      scene.labels.push_back({text, -16, -16});
    }
  }
}

}  // namespace render
