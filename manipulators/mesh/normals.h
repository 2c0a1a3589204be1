#pragma once

#include <Eigen/Core>

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

}  // namespace mesh
