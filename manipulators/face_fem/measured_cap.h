#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "manipulators/face_fem/basis.h"
#include "manipulators/face_fem/muscle.h"
#include "manipulators/face_fem/statics.h"

namespace face {

/// The layered cap with its load, on which elements, rules and frame methods are measured against each other.
struct Mesh {
  int nx = 0, ny = 0, nz = 0;
  std::string name() const { return std::to_string(nx) + "x" + std::to_string(ny) + "x" + std::to_string(nz); }
};

/// `count` muscles strewn over the cap: origin in bone, insertion a sphere of `radius` metres below the skin.
std::vector<Muscle> cap_muscles(int count, double radius);

/// Place on the cap at angles left, up (radians) and distance r (metres) from its centre.
Eigen::Vector3d cap_place(double left, double up, double r);

/// Displacement of a grid of side^2 points of the outer surface of cap(element, mesh), found through the mesh's own
/// parameters, so that meshes and elements can be compared point by point: 3 by side^2.
Eigen::Matrix3Xd surface_samples(const Model& model, const Mesh& mesh, const Field& u, int side);

/// |a - b| / |b| over all entries.
double relative_difference(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b);

/// Vertices strewn evenly over the skin of the cap, on its smooth surface: 3 by count, metres.
Eigen::Matrix3Xd cap_vertices(int count);

/// CPU milliseconds of one call of `work`, the best of several within about `budget` seconds.
template <class Work>
double best_ms(double budget, Work&& work);

}  // namespace face

#include "manipulators/face_fem/clock.h"

template <class Work>
double face::best_ms(double budget, Work&& work) {
  double best = 1e300, spent = 0;
  for (int run = 0; run < 3 || (spent < budget && run < 1000); ++run) {
    const double begin = cpu_seconds();
    work();
    const double took = cpu_seconds() - begin;
    spent += took;
    best = took < best ? took : best;
    if (spent > 4 * budget) break;
  }
  return 1e3 * best;
}
