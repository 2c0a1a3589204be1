#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/mesh/surface.h"

namespace mesh {

/// Area-weighted vertex normals: the sum of cross products of the faces around each *position*, so vertices that lie
/// on top of each other (texture seams, part borders) get the same normal and no crease is seen.
/// A vertex without area gets +Y. Returns #V by 3 unit vectors.
Eigen::MatrixX3f vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F);

/// Vertices at the same position (exactly equal coordinates) share one number: for each vertex the lowest index that
/// lies where it does. Computed once, it makes the normals of a moving surface cheap.
Eigen::VectorXi welded(const Eigen::MatrixX3f& V);

/// As vertex_normals, with `weld` from welded() of the surface at rest. No allocation beyond N.
void vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld,
                    Eigen::MatrixX3f& N);

/// The part of a surface whose normals change when some vertices move.
struct Patch {
  std::vector<int> moved;     ///< the vertices that move, rising
  std::vector<int> vertices;  ///< whose normals change: every corner of a face that moves, rising
  std::vector<int> faces;     ///< all faces around `vertices`, rising
};

/// The patch of the vertices `moved` (any order), which must be numbers of vertices.
Patch patch_around(const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld, std::vector<int> moved);

/// As vertex_normals for the vertices of `patch` alone; the other rows of N stay. The same bits as for all.
void vertex_normals(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F, const Eigen::VectorXi& weld,
                    const Patch& patch, Eigen::MatrixX3f& N);

}  // namespace mesh
