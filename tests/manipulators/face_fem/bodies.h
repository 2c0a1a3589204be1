#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <vector>

#include "manipulators/face_fem/grid.h"
#include "manipulators/face_fem/load.h"
#include "manipulators/face_fem/statics.h"

// The bodies on which hexahedra are judged in the literature, built from their published dimensions.
namespace face::bodies {

using Vec3 = Eigen::Vector3d;
constexpr double pi = 3.14159265358979323846;

/// A body and its load.
struct Case {
  Model model;
  Field load;
};

inline Case make_case(Model model, double young, double poisson) {
  model.materials = {{"material", young, poisson, 1}};
  for (Hexahedron& h : model.hexahedra) h.material = 0;
  Case made{std::move(model), {}};
  made.load = Field::Zero(3, int(made.model.nodes.size()));
  return made;
}

inline void hold(Model& model, int node, std::array<bool, 3> axes, const Vec3& shift = Vec3::Zero()) {
  for (Support& s : model.supports)
    if (s.node == node) {
      for (int i = 0; i < 3; ++i)
        if (axes[i]) {
          s.held[i] = true;
          s.shift[i] = shift[i];
        }
      return;
    }
  Support s;
  s.node = node;
  s.held = axes;
  s.shift = shift;
  model.supports.push_back(s);
}

inline void hold_where(Model& model, const std::function<bool(const Vec3&)>& chosen, std::array<bool, 3> axes) {
  for (int n = 0; n < int(model.nodes.size()); ++n)
    if (chosen(model.nodes[n])) hold(model, n, axes);
}

/// Spreads a force over a side as a uniform traction (force per area), integrated over each element side.
inline void add_traction(const Model& model, const std::vector<Side>& sides, const Vec3& total, Field& load) {
  // a pressure gives the area vector of each node; its length along the mean normal is the node's share of the area
  Field areas = Field::Zero(3, load.cols());
  for (const Side& side : sides) add_pressure(model, side, -1, areas);
  const Vec3 normal = Vec3(areas.rowwise().sum()).normalized();
  const double area = areas.rowwise().sum().norm();
  for (int n = 0; n < load.cols(); ++n) load.col(n) += areas.col(n).dot(normal) / area * total;
}

/// Mean displacement of the nodes within `radius` of a point.
inline Vec3 mean_near(const Model& model, const Field& u, const std::function<bool(const Vec3&)>& chosen) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int n = 0; n < int(model.nodes.size()); ++n)
    if (chosen(model.nodes[n])) {
      sum += u.col(n);
      ++count;
    }
  return sum / count;
}

/// The seven-element cube of MacNeal and Harder (1985): unit cube round eight inner nodes in general position.
inline Model patch_cube(Element element) {
  static const Vec3 inner[8] = {{.249, .342, .192}, {.826, .288, .288}, {.850, .649, .263}, {.273, .750, .230},
                                {.320, .186, .643}, {.677, .305, .683}, {.788, .693, .644}, {.165, .745, .702}};
  const auto outer = [](int a) {
    return Vec3(a == 1 || a == 2 || a == 5 || a == 6, a == 2 || a == 3 || a == 6 || a == 7, a >= 4);
  };
  std::vector<std::array<Vec3, 8>> bricks(1);
  for (int a = 0; a < 8; ++a) bricks[0][a] = inner[a];
  // each side of the inner brick is joined to the side of the cube
  for (const auto& side : side_nodes) {
    std::array<Vec3, 8> brick;
    for (int k = 0; k < 4; ++k) {
      brick[k] = inner[side[k]];
      brick[4 + k] = outer(side[k]);
    }
    bricks.push_back(brick);
  }
  static constexpr int ends[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                      {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  Model model;
  model.element = element;
  const auto node_at = [&](const Vec3& p) {
    for (int n = 0; n < int(model.nodes.size()); ++n)
      if ((model.nodes[n] - p).norm() < 1e-9) return n;
    model.nodes.push_back(p);
    return int(model.nodes.size()) - 1;
  };
  for (const auto& brick : bricks) {
    Hexahedron h;
    for (int a = 0; a < 8; ++a) h.node[a] = node_at(brick[a]);
    if (nodes_of(element) == 20)
      for (int e = 0; e < 12; ++e) h.node[8 + e] = node_at((brick[ends[e][0]] + brick[ends[e][1]]) / 2);
    model.hexahedra.push_back(h);
  }
  return model;
}

/// MacNeal and Harder's straight cantilever, 6 x 0.2 x 0.1, E 1e7, nu 0.3, unit tip force; `slant` 0 regular, 1
/// trapezoids, 2 parallelograms (45 degrees in the x-y plane).
inline Case straight_beam(Element element, int slant, const Vec3& force) {
  Model model = grid(element, 6, 1, 1, [&](const Vec3& p) {
    const double cell = p.x() * 6, whole = std::round(cell);
    const double lean = 0.1 * (2 * p.y() - 1);
    // inner cross-sections lean by 45 degrees, alternating for trapezoids; between them positions are linear
    const auto tilt = [&](double line) {
      const int k = int(std::lround(line));
      if (k == 0 || k == 6 || slant == 0) return 0.0;
      return slant == 2 || k % 2 == 1 ? lean : -lean;
    };
    const double low = std::floor(cell), part = cell - low;
    const double shift = std::abs(cell - whole) < 1e-9 ? tilt(whole) : (1 - part) * tilt(low) + part * tilt(low + 1);
    return Vec3(cell + shift, 0.2 * p.y(), 0.1 * p.z());
  });
  Case beam = make_case(model, 1e7, 0.3);
  hold_where(beam.model, [](const Vec3& p) { return p.x() < 1e-9; }, {true, true, true});
  add_traction(beam.model, grid_sides(6, 1, 1, 0, true), force, beam.load);
  return beam;
}

/// Their twisted beam: length 12, width 1.1, depth 0.32, 90 degrees of twist, E 29e6, nu 0.22, unit tip force.
inline Case twisted_beam(Element element, int nx, int ny, int nz, const Vec3& force) {
  Model model = grid(element, nx, ny, nz, [](const Vec3& p) {
    const double angle = p.x() * pi / 2, y = 1.1 * (p.y() - 0.5), z = 0.32 * (p.z() - 0.5);
    return Vec3(12 * p.x(), y * std::cos(angle) - z * std::sin(angle), y * std::sin(angle) + z * std::cos(angle));
  });
  Case beam = make_case(model, 29e6, 0.22);
  hold_where(beam.model, [](const Vec3& p) { return p.x() < 1e-9; }, {true, true, true});
  add_traction(beam.model, grid_sides(nx, ny, nz, 0, true), force, beam.load);
  return beam;
}

/// Their curved beam: quarter circle from radius 4.12 to 4.32, depth 0.1, E 1e7, nu 0.25, unit tip force.
inline Case curved_beam(Element element, int nx, int ny, int nz, const Vec3& force) {
  Model model = grid(element, nx, ny, nz, [](const Vec3& p) {
    // held on the x axis, the tip is on the y axis
    const double angle = p.x() * pi / 2, r = 4.32 - 0.2 * p.y();
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0.1 * p.z());
  });
  Case beam = make_case(model, 1e7, 0.25);
  hold_where(beam.model, [](const Vec3& p) { return p.y() < 1e-9; }, {true, true, true});
  add_traction(beam.model, grid_sides(nx, ny, nz, 0, true), force, beam.load);
  return beam;
}

/// Cook's tapered membrane, n by n by 1, thickness 1, shear 1 on the free end; plane strain holds z everywhere.
inline Case cook(Element element, int n, double young, double poisson, bool plane_strain) {
  Model model = grid(element, n, n, 1, [](const Vec3& p) {
    const double x = 48 * p.x(), low = 44 * p.x(), high = 44 + 16 * p.x();
    return Vec3(x, low + (high - low) * p.y(), p.z());
  });
  Case membrane = make_case(model, young, poisson);
  hold_where(membrane.model, [](const Vec3& p) { return p.x() < 1e-9; }, {true, true, false});
  // plane stress holds the middle plane of the thickness; with one layer that is the rigid motion along z
  hold_where(membrane.model, [&](const Vec3& p) { return plane_strain || p.z() < 1e-9; }, {false, false, true});
  add_traction(membrane.model, grid_sides(n, n, 1, 0, true), Vec3(0, 1, 0), membrane.load);
  return membrane;
}

/// Vertical displacement in the middle of Cook's free end.
inline double cook_tip(const Case& membrane, const Field& u) {
  return mean_near(membrane.model, u,
                   [](const Vec3& p) { return std::abs(p.x() - 48) < 1e-6 && std::abs(p.y() - 52) < 1e-6; })
      .y();
}

/// NAFEMS LE10: a quarter of a thick elliptic plate (inner 2 x 1, outer 3.25 x 2.75, thickness 0.6), pressure 1 MPa on
/// top, E 210 GPa, nu 0.3. nr cells from the hole outward, nc around, nz through the thickness.
inline Case le10(Element element, int nr, int nc, int nz) {
  Model model = grid(element, nc, nr, nz, [](const Vec3& p) {
    // round from the y axis to the x axis, so that x, y, z of the grid stay right-handed
    const double angle = (1 - p.x()) * pi / 2;
    const double a = 2 + 1.25 * p.y(), b = 1 + 1.75 * p.y();
    return Vec3(a * std::cos(angle), b * std::sin(angle), 0.6 * p.z());
  });
  Case plate = make_case(model, 210e9, 0.3);
  hold_where(plate.model, [](const Vec3& p) { return p.x() < 1e-9; }, {true, false, false});
  hold_where(plate.model, [](const Vec3& p) { return p.y() < 1e-9; }, {false, true, false});
  for (int n : nodes_of_sides(plate.model, grid_sides(nc, nr, nz, 1, true))) {
    hold(plate.model, n, {true, true, false});
    // the middle line of the outer edge carries the plate
    if (std::abs(plate.model.nodes[n].z() - 0.3) < 1e-9) hold(plate.model, n, {false, false, true});
  }
  for (const Side& side : grid_sides(nc, nr, nz, 2, true)) add_pressure(plate.model, side, 1e6, plate.load);
  return plate;
}

}  // namespace face::bodies
