#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "manipulators/mesh/skin.h"
#include "manipulators/render/faces.h"
#include "manipulators/render/scene.h"
#include "objdb/database.h"

namespace render {

/// What became of a mesh or skin: a word of mesh.status and a sentence.
struct Report {
  objdb::ObjectId object = 0;
  std::string status = "ok";
  std::string reason;
  bool operator==(const Report&) const = default;
};

/// Surfaces read from files and skins bound to bones, kept between pictures and made anew only when what they are
/// made of changes.
class Skins {
 public:
  /// The geometry of a `mesh` object, shared by all that name the same file unless a face moves it; null with a report
  /// when it cannot be had. `parts` receives the names of its materials.
  std::shared_ptr<const Geometry> mesh(const objdb::Database& world, const objdb::Object& object, Report& report,
                                       std::vector<std::string>& parts);

  /// The geometry of a `skin` object in the pose its bones have now, in world coordinates; null with a report when
  /// there is nothing to bind. Faces move it before its bones do. `materials` receives one material a part.
  std::shared_ptr<const Geometry> skin(const objdb::Database& world, const objdb::Object& object, Report& report,
                                       std::vector<Material>& materials);

  /// The geometry of an object that carries its surface itself, as programs that compute one do: fields `vertices`
  /// (vec3[] or real[]) in its own frame and `triangles` (int[], three corners each). Normals are made anew with every
  /// change. Null with a report when the arrays do not fit together.
  std::shared_ptr<const Geometry> carried(const objdb::Object& object, Report& report);

  /// The bound skin of that object, null before its first picture; for exporting.
  const mesh::Skin* bound(objdb::ObjectId skin) const;
  /// Where its vertices are in the bind pose, with the face's expression. Of bound skins only.
  const Eigen::MatrixX3f& rest(objdb::ObjectId skin) const;
  /// Where what faces move of that surface is now, in world coordinates; empty when nothing is.
  Eigen::AlignedBox3f moved_box(objdb::ObjectId surface) const;
  /// The bones of that skin in the order of mesh::Skin::bones.
  const std::vector<objdb::ObjectId>& bones(objdb::ObjectId skin) const;

 private:
  struct File {
    std::shared_ptr<Geometry> geometry;
    Eigen::MatrixX3f V;
    Eigen::MatrixX3i F;
    mesh::Origin origin;
    std::vector<std::string> parts;
    Report report;
  };
  struct Body {
    bool made = false;
    std::uint64_t made_of = 0;  // hash of all it was made of
    std::string file;
    mesh::Skin skin;
    std::vector<objdb::ObjectId> bones;
    Faces faces;
    mesh::Patch patch;      // what the faces move
    Eigen::MatrixX3f rest;  // in the bind pose, moved by the faces
    Eigen::MatrixX3f V, N;  // in the last pose
    std::vector<Eigen::Isometry3d> pose;
    mesh::Blend blend = mesh::Blend::dual_quaternion;
    std::shared_ptr<Geometry> geometry;
    Report report;
  };

  // a mesh of which a face moves vertices
  struct Moved {
    std::string file;
    Faces faces;
    std::shared_ptr<Geometry> geometry;
  };
  struct Carried {
    std::uint64_t triangles = 0, vertices = 0;  // hashes
    std::shared_ptr<Geometry> geometry;
    Report report;
  };

  void bind(const objdb::Database& world, const objdb::Object& object, Body& body);
  void pose(const objdb::Database& world, const objdb::Object& object, Body& body);

  std::map<std::string, File> files_;
  std::map<objdb::ObjectId, Body> bodies_;
  std::map<objdb::ObjectId, Moved> moved_;
  std::map<objdb::ObjectId, Carried> carried_;
};

/// The surface as a geometry of one span a part, with levels of detail. Empty parts have empty spans.
std::shared_ptr<Geometry> geometry_of(const mesh::Surface& surface);

/// The look of a part that no material or garment describes, by its name: eyes, lips, hair, teeth ... ; otherwise
/// `otherwise`.
Material usual_look(const std::string& part, const Material& otherwise);

}  // namespace render
