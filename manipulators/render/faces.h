#pragma once

#include <optional>
#include <string>
#include <vector>

#include "manipulators/mesh/origin.h"
#include "objdb/database.h"

namespace render {

/// What the objects of type `face` do to one surface: they move vertices of its file (`vertices`, numbers as
/// mesh::read_surface gives them) by `displacement`, in the surface's own frame, before its bones do.
class Faces {
 public:
  /// What became of the surface since the last look.
  enum class Change {
    none,
    displaced,  ///< the same vertices are elsewhere
    others,     ///< other vertices move than before
  };
  /// Looks at the faces of `surface`, whose vertices come from its file as `origin` tells. A face that does not fit
  /// moves nothing, and problem() says why.
  Change look(const objdb::Database& world, const objdb::Object& surface, const mesh::Origin& origin);

  /// Adds the displacements to `V`, the surface at rest.
  void add(Eigen::MatrixX3f& V) const;
  /// The vertices that are moved by some face.
  std::vector<int> vertices() const;
  const std::string& problem() const { return problem_; }

 private:
  struct One {
    objdb::ObjectId face = 0;
    std::uint64_t vertices = 0;      // hash
    std::uint64_t displacement = 0;  // hash
    std::vector<double> by;          // three numbers a vertex, or none
    std::optional<mesh::Follower> follower;
    std::string problem;
  };
  std::vector<One> faces_;
  std::string problem_;
};

}  // namespace render
