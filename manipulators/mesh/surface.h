#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mesh {

/// A triangulated surface, the one currency of this library.
///
/// Invariants kept by every function that returns one: indices of `F` lie in [0, #V), `part` has one entry per face
/// lying in [0, part_names.size()), all numbers are finite, `N` is either #V by 3 or 0 by 3 (not computed yet).
struct Surface {
  Eigen::MatrixX3f V;                   ///< #V by 3 vertex positions, metres
  Eigen::MatrixX3i F;                   ///< #F by 3 vertex indices, counter-clockwise seen from outside
  Eigen::MatrixX3f N;                   ///< #V by 3 unit normals, outward
  std::vector<int> part;                ///< #F part of each face, an index into `part_names`
  std::vector<std::string> part_names;  ///< e.g. skin, eyes, blouse; at least one when there are faces
};

/// An axis-aligned box; `lower` > `upper` when empty.
struct Bounds {
  Eigen::Vector3f lower, upper;
};

/// The box around all vertices of `surface`.
Bounds bounds(const Surface& surface);

/// Appends `other` to `surface`, parts of equal name becoming one. Normals survive only when both have them.
void append(Surface& surface, const Surface& other);

/// The faces of `surface` for which `keep[face]` holds, with the vertices they use and no others.
/// `vertex_map`, when given, receives for each new vertex its old index.
Surface subset(const Surface& surface, const std::vector<bool>& keep, std::vector<int>* vertex_map = nullptr);

}  // namespace mesh
