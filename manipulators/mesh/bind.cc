#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "manipulators/mesh/normals.h"
#include "manipulators/mesh/skin.h"
#include "manipulators/mesh/topology.h"
#include "manipulators/mesh/tree.h"

namespace mesh {
namespace {

using Laplacian = Eigen::SparseMatrix<double>;

/// A bone's axis in the surface's frame.
struct Axis {
  Eigen::Vector3d from, to;
  double radius;

  Eigen::Vector3d nearest(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d along = to - from;
    const double length2 = along.squaredNorm();
    const double share = length2 > 0 ? std::clamp((p - from).dot(along) / length2, 0.0, 1.0) : 0.0;
    return from + share * along;
  }
};

std::vector<Axis> axes(const std::vector<Bone>& bones) {
  std::vector<Axis> result;
  for (const Bone& bone : bones) {
    result.push_back({bone.bind * bone.from, bone.bind * bone.to, bone.radius});
  }
  return result;
}

/// Cotangent Laplacian with the negative weights of obtuse corners cut off, so that it stays an M-matrix and no heat
/// falls below zero, and the vertex areas (a third of each face), square metres.
void assemble(const Surface& surface, Laplacian& L, Eigen::VectorXd& area) {
  std::vector<Eigen::Triplet<double>> entries;
  area = Eigen::VectorXd::Zero(surface.V.rows());
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int i = surface.F(f, corner);
      const int j = surface.F(f, (corner + 1) % 3);
      const int k = surface.F(f, (corner + 2) % 3);
      const Eigen::Vector3d p = surface.V.row(k).transpose().cast<double>();
      const Eigen::Vector3d a = surface.V.row(i).transpose().cast<double>() - p;
      const Eigen::Vector3d b = surface.V.row(j).transpose().cast<double>() - p;
      const double doubled_area = a.cross(b).norm();
      area[i] += doubled_area / 6;
      // slivers would conduct without bound; 20 is the cotangent of 3 degrees
      const double weight = doubled_area > 0 ? std::clamp(0.5 * a.dot(b) / doubled_area, 1e-3, 20.0) : 1e-3;
      entries.emplace_back(i, j, -weight);
      entries.emplace_back(j, i, -weight);
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
    }
  }
  L.resize(surface.V.rows(), surface.V.rows());
  L.setFromTriplets(entries.begin(), entries.end());
}

/// The bone that heats a vertex and how strongly (1/m2); bone -1 when it sees none.
struct Heater {
  int bone = -1;
  double strength = 0;
};

/// Baran and Popovic heat with 1/distance^2, so that a border between bones is as wide as the limb is thick. On a trunk
/// that is too wide: an arm would pull at the waist. With 1/(spread distance) the width grows with the square root.
constexpr double spread = 0.025;

/// The nearest bone, measured in its own radii, that the vertex sees through the inside of the body.
Heater heater(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, const std::vector<Axis>& bones,
              const Tree& tree) {
  std::vector<std::pair<double, int>> order;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    order.emplace_back((bones[b].nearest(p) - p).norm() / bones[b].radius, static_cast<int>(b));
  }
  std::sort(order.begin(), order.end());
  for (const auto& [relative, b] : order) {
    const Eigen::Vector3d target = bones[b].nearest(p);
    const double distance = (target - p).norm();
    // start a little under the skin; a bone on the outer side of the tangent plane is not seen
    const Eigen::Vector3d start = p - 1e-4 * normal;
    if ((target - p).dot(normal) < 0.17 * distance && tree.first_hit(start, target).face < 0) {
      return {b, 1 / (spread * std::max(distance, 1e-3))};
    }
  }
  return {};
}

std::string fault(const Surface& surface, const std::vector<Bone>& bones) {
  if (surface.V.rows() == 0 || surface.F.rows() == 0) {
    return "a skin needs a surface with vertices and faces; this one is empty";
  }
  if (!surface.V.allFinite()) {
    return "a skin needs finite vertices";
  }
  if (bones.empty()) {
    return "a skin needs at least one bone; there is none";
  }
  for (const Bone& bone : bones) {
    if (!bone.bind.matrix().allFinite() || !bone.from.allFinite() || !bone.to.allFinite() || !(bone.radius > 0) ||
        !std::isfinite(bone.radius)) {
      return "bone " + bone.name + " needs finite positions and a radius above 0";
    }
    if (bone.twist_from >= static_cast<int>(bones.size())) {
      return "bone " + bone.name + " takes its twist from a bone that does not exist";
    }
  }
  return "";
}

/// Vertices whose whole component sees no bone (an eyeball inside the head) follow the bone nearest to its middle.
void adopt_blind_components(const Surface& surface, const std::vector<Axis>& bones, std::vector<Heater>& heaters) {
  const std::vector<int> component = components(surface);
  const int count = *std::max_element(component.begin(), component.end()) + 1;
  std::vector<bool> sees(count, false);
  std::vector<Eigen::Vector3d> middle(count, Eigen::Vector3d::Zero());
  std::vector<int> corners(count, 0);
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int v = surface.F(f, corner);
      sees[component[f]] = sees[component[f]] || heaters[v].bone >= 0;
      middle[component[f]] += surface.V.row(v).transpose().cast<double>();
      ++corners[component[f]];
    }
  }
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    const int c = component[f];
    if (sees[c]) {
      continue;
    }
    const Eigen::Vector3d centre = middle[c] / corners[c];
    const auto nearer = [&](const Axis& g, const Axis& h) {
      return (g.nearest(centre) - centre).norm() < (h.nearest(centre) - centre).norm();
    };
    const int nearest = static_cast<int>(std::min_element(bones.begin(), bones.end(), nearer) - bones.begin());
    for (int corner = 0; corner < 3; ++corner) {
      heaters[surface.F(f, corner)] = {nearest, 1e6};
    }
  }
}

/// Heat never ends: far from a bone a trace of it would still pull. Shares below this are cut off, and the others lose
/// as much, so that nothing jumps where one fades out.
constexpr double trace = 0.03;

/// Keeps the largest weights of a vertex and makes them sum to one.
void keep_largest(const Eigen::RowVectorXd& all_heat, Eigen::Index v, Skin& skin) {
  const Eigen::RowVectorXd heat = (all_heat.array() - trace * all_heat.maxCoeff()).cwiseMax(0.0);
  std::vector<int> order(heat.size());
  std::iota(order.begin(), order.end(), 0);
  const int kept = std::min<int>(Skin::influences, static_cast<int>(order.size()));
  std::partial_sort(order.begin(), order.begin() + kept, order.end(),
                    [&](int a, int b) { return std::pair(-heat[a], a) < std::pair(-heat[b], b); });
  double sum = 0;
  for (int i = 0; i < kept; ++i) {
    sum += heat[order[i]];
  }
  for (int i = 0; i < kept; ++i) {
    const double weight = heat[order[i]] / sum;
    skin.index(v, i) = weight > 0 ? order[i] : 0;
    skin.weight(v, i) = static_cast<float>(weight);
  }
}

}  // namespace

Result<Skin> bind_skin(Surface surface, std::vector<Bone> bones) {
  if (const std::string sentence = fault(surface, bones); !sentence.empty()) {
    return Error{"range", sentence};
  }
  if (surface.N.rows() != surface.V.rows()) {
    surface.N = vertex_normals(surface.V, surface.F);
  }
  const Eigen::Index vertices = surface.V.rows();
  const std::vector<Axis> axis = axes(bones);
  const Tree tree(surface.V, surface.F);

  std::vector<Heater> heaters(vertices);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    heaters[v] =
        heater(surface.V.row(v).transpose().cast<double>(), surface.N.row(v).transpose().cast<double>(), axis, tree);
  }
  adopt_blind_components(surface, axis, heaters);

  // stationary heat: (L + A H) w = A H p, one right-hand side per bone
  Laplacian system;
  Eigen::VectorXd area;
  assemble(surface, system, area);
  Eigen::VectorXd gain(vertices);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    // a floor keeps vertices of no face, and components that see a bone nowhere near, solvable
    gain[v] = std::max(area[v], 1e-12) * std::max(heaters[v].strength, 1e-9);
    system.coeffRef(v, v) += gain[v];
  }
  const Eigen::SimplicialLDLT<Laplacian> solver(system);
  if (solver.info() != Eigen::Success) {
    return Error{"range", "the skin's heat equation has no solution; the surface is degenerate"};
  }
  Eigen::MatrixXd heat(vertices, bones.size());
  for (std::size_t b = 0; b < bones.size(); ++b) {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(vertices);
    for (Eigen::Index v = 0; v < vertices; ++v) {
      if (heaters[v].bone == static_cast<int>(b)) {
        load[v] = gain[v];
      }
    }
    heat.col(b) = load.isZero() ? load : Eigen::VectorXd(solver.solve(load));
  }

  Skin skin;
  skin.index = Skin::Indices::Zero(vertices, Skin::influences);
  skin.weight = Skin::Weights::Zero(vertices, Skin::influences);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    keep_largest(heat.row(v), v, skin);
  }
  skin.weld = welded(surface.V);
  skin.origin = own_origin(surface.V.rows());
  skin.surface = std::move(surface);
  skin.bones = std::move(bones);
  return skin;
}

}  // namespace mesh
