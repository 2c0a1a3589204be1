// Bodies with answers in the literature. What an element should give on each mesh was found independently with deal.II,
// dolfinx and CalculiX on the same meshes; the tolerance is half of the last digit given there.
#include <gtest/gtest.h>

#include "manipulators/face_fem/stress.h"
#include "tests/manipulators/face_fem/bodies.h"

namespace face {
namespace {

using bodies::Case;
using bodies::Vec3;

Field answer(const Case& body) {
  auto statics = Statics::make(body.model);
  EXPECT_TRUE(statics) << statics.error().sentence;
  if (!statics) return Field::Zero(3, body.load.cols());
  const Solution solution = statics->solve(body.load);
  // in a thin beam stiff terms cancel: |K| |u| is up to 1e8 times the load, so rounding leaves that much of 1e-16
  EXPECT_LE(solution.residual, 1e-7);
  return solution.u;
}

double straight(Element element, int slant, bool in_plane) {
  const Case beam = bodies::straight_beam(element, slant, in_plane ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
  const Vec3 tip = bodies::mean_near(beam.model, answer(beam), [](const Vec3& p) { return p.x() > 6 - 1e-9; });
  // beam theory: 0.1081 in the plane, 0.4321 out of it
  return in_plane ? tip.y() / 0.1081 : tip.z() / 0.4321;
}

TEST(StraightBeam, BendsAsTheElementsShould) {
  EXPECT_NEAR(straight(Element::hex8, 0, true), .093, .0006);
  EXPECT_NEAR(straight(Element::hex8, 0, false), .025, .0006);
  EXPECT_NEAR(straight(Element::bbar, 0, true), .100, .0006);
  EXPECT_NEAR(straight(Element::wt, 0, true), .978, .0006);
  EXPECT_NEAR(straight(Element::wt, 0, false), .973, .0006);
  EXPECT_NEAR(straight(Element::wt, 1, true), .047, .0006);
  EXPECT_NEAR(straight(Element::wt, 2, true), .624, .0006);
  EXPECT_NEAR(straight(Element::hex20, 0, true), .970, .0006);
  EXPECT_NEAR(straight(Element::hex20, 0, false), .961, .0006);
  EXPECT_NEAR(straight(Element::hex20, 1, true), .886, .0006);
  EXPECT_NEAR(straight(Element::hex20, 1, false), .920, .0006);
}

TEST(StraightBeam, IsRefusedWithReducedQuadraticElementsInARowOneWide) {
  auto statics = Statics::make(bodies::straight_beam(Element::hex20r, 0, {0, 1, 0}).model);
  ASSERT_FALSE(statics);
  EXPECT_EQ(statics.error().fault, Fault::zero_mode);
}

double twisted(Element element, int nx, int ny, int nz, bool along_z) {
  const Case beam = bodies::twisted_beam(element, nx, ny, nz, along_z ? Vec3(0, 0, 1) : Vec3(0, 1, 0));
  const Vec3 tip = bodies::mean_near(beam.model, answer(beam), [](const Vec3& p) { return p.x() > 12 - 1e-9; });
  return along_z ? tip.z() / 5.424e-3 : tip.y() / 1.754e-3;
}

TEST(TwistedBeam, BendsAsTheElementsShould) {
  EXPECT_NEAR(twisted(Element::hex8, 12, 2, 2, true), .208, .0006);
  EXPECT_NEAR(twisted(Element::bbar, 12, 2, 2, true), .215, .0006);
  EXPECT_GE(twisted(Element::wt, 12, 2, 2, true), .985);
  EXPECT_GE(twisted(Element::wt, 12, 2, 2, false), .985);
  EXPECT_NEAR(twisted(Element::hex20, 12, 2, 2, true), .993, .0006);
  EXPECT_NEAR(twisted(Element::hex20, 12, 2, 2, false), .996, .0006);
  EXPECT_NEAR(twisted(Element::hex20r, 12, 2, 2, true), .997, .0006);
}

double curved(Element element, int nx, int ny, int nz, bool in_plane) {
  const Case beam = bodies::curved_beam(element, nx, ny, nz, in_plane ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
  const Vec3 tip = bodies::mean_near(beam.model, answer(beam), [](const Vec3& p) { return p.x() < 1e-9; });
  return in_plane ? tip.y() / 0.08734 : tip.z() / 0.5022;
}

TEST(CurvedBeam, BendsAsTheElementsShould) {
  EXPECT_NEAR(curved(Element::wt, 6, 1, 1, true), .880, .0006);
  EXPECT_NEAR(curved(Element::wt, 6, 1, 1, false), .809, .0006);
  EXPECT_NEAR(curved(Element::hex20r, 6, 1, 1, true), 1.006, .0006);
  EXPECT_NEAR(curved(Element::hex20r, 6, 1, 1, false), .943, .0006);
  EXPECT_NEAR(curved(Element::hex20, 12, 2, 2, true), 1.000, .0006);
}

TEST(CooksMembrane, ConvergesInPlaneStress) {
  const auto tip = [](Element element, int n) {
    const Case membrane = bodies::cook(element, n, 1, 1.0 / 3, false);
    return bodies::cook_tip(membrane, answer(membrane));
  };
  // two-dimensional reference 23.96
  EXPECT_NEAR(tip(Element::hex8, 4), 17.78, .006);
  EXPECT_NEAR(tip(Element::bbar, 8), 22.77, .006);
  EXPECT_NEAR(tip(Element::wt, 8), 23.67, .006);
  EXPECT_NEAR(tip(Element::hex20, 8), 23.88, .006);
  EXPECT_NEAR(tip(Element::hex20r, 8), 23.89, .006);
}

TEST(CooksMembrane, DoesNotLockWithMeanDilatationWhenNearlyIncompressible) {
  const auto tip = [](Element element, int n) {
    const Case membrane = bodies::cook(element, n, 1, .4999, true);
    return bodies::cook_tip(membrane, answer(membrane));
  };
  // reference 18.49 from triquadratic elements with selective integration on 48 x 48
  EXPECT_NEAR(tip(Element::hex8, 8), 5.35, .006);
  EXPECT_NEAR(tip(Element::bbar, 8), 17.65, .006);
  EXPECT_NEAR(tip(Element::hex20r, 8), 17.92, .006);
}

TEST(ThickPlateLE10, HasTheStressOfNafems) {
  const auto at_d = [](Element element, int nr, int nc, int nz) {
    const Case plate = bodies::le10(element, nr, nc, nz);
    const Field u = answer(plate);
    const auto stress = stress_field(plate.model, u);
    for (int n = 0; n < u.cols(); ++n)
      if ((plate.model.nodes[n] - Vec3(2, 0, 0.6)).norm() < 1e-9) return std::pair(stress(1, n) / 1e6, u(2, n));
    return std::pair(0.0, 0.0);
  };
  // -5.38 MPa, to 2.5 %: finer meshes settle near -5.45 .. -5.50
  EXPECT_NEAR(at_d(Element::hex20r, 4, 6, 2).first, -5.38, 0.025 * 5.38);
  const auto [stress, sag] = at_d(Element::hex20r, 8, 12, 4);
  EXPECT_NEAR(stress, -5.38, 0.025 * 5.38);
  // CalculiX C3D20R on the same mesh
  EXPECT_NEAR(sag, -1.0069e-4, 0.6e-8);
  EXPECT_NEAR(at_d(Element::hex20, 4, 6, 2).first, -5.38, 0.025 * 5.38);
}

/// octant of a thick sphere, radii 1 and 2, unit pressure inside; three blocks of n^3 meet along the diagonal
Case thick_sphere(Element element, int n, double poisson) {
  Model model;
  model.element = element;
  std::vector<Side> inner;
  const auto node_at = [&](const Vec3& p) {
    // blocks share their border nodes
    for (int k = int(model.nodes.size()) - 1; k >= 0; --k)
      if ((model.nodes[k] - p).squaredNorm() < 1e-18) return k;
    model.nodes.push_back(p);
    return int(model.nodes.size()) - 1;
  };
  for (int block = 0; block < 3; ++block) {
    const Model part = grid(element, n, n, n, [&](const Vec3& p) {
      // one third of the unit cube's outer faces, corner in the diagonal, thrown onto the sphere; equal angles
      const double s = std::tan(p.x() * bodies::pi / 4), t = std::tan(p.y() * bodies::pi / 4);
      Vec3 direction(s, t, 1);
      Vec3 turned;
      for (int i = 0; i < 3; ++i) turned[(i + block) % 3] = direction[i];
      return Vec3((1 + p.z()) * turned.normalized());
    });
    std::vector<int> renamed(part.nodes.size());
    for (int k = 0; k < int(part.nodes.size()); ++k) renamed[k] = node_at(part.nodes[k]);
    const int first = int(model.hexahedra.size());
    for (Hexahedron h : part.hexahedra) {
      for (int a = 0; a < nodes_of(element); ++a) h.node[a] = renamed[h.node[a]];
      model.hexahedra.push_back(h);
    }
    for (Side side : grid_sides(n, n, n, 2, false)) inner.push_back({side.hexahedron + first, side.side});
  }
  Case sphere = bodies::make_case(model, 1, poisson);
  for (int i = 0; i < 3; ++i) {
    std::array<bool, 3> axis = {false, false, false};
    axis[i] = true;
    bodies::hold_where(
        sphere.model, [&](const Vec3& p) { return std::abs(p[i]) < 1e-9; }, axis);
  }
  for (const Side& side : inner) add_pressure(sphere.model, side, 1, sphere.load);
  return sphere;
}

/// relative error over the nodes against Lame's solution for pressure p inside radii a, b
double sphere_error(Element element, int n, double nu) {
  const Case sphere = thick_sphere(element, n, nu);
  const Field u = answer(sphere);
  double miss = 0, size = 0;
  for (int k = 0; k < u.cols(); ++k) {
    const double r = sphere.model.nodes[k].norm(), b3 = 8;
    // u = p a^3 / (E (b^3 - a^3)) ((1 - 2 nu) r + (1 + nu) b^3 / (2 r^2))
    const double exact = 1 / (b3 - 1) * ((1 - 2 * nu) * r + (1 + nu) * b3 / (2 * r * r));
    miss += (u.col(k) - exact * sphere.model.nodes[k] / r).squaredNorm();
    size += exact * exact;
  }
  return std::sqrt(miss / size);
}

TEST(ThickSphere, ConvergesWithoutLockingAtPoisson04999) {
  const double coarse = sphere_error(Element::bbar, 4, .4999), fine = sphere_error(Element::bbar, 8, .4999);
  EXPECT_LE(fine, .005);
  EXPECT_GE(std::log2(coarse / fine), 1.9);
  const double coarse20 = sphere_error(Element::hex20r, 2, .4999), fine20 = sphere_error(Element::hex20r, 4, .4999);
  EXPECT_GE(std::log2(coarse20 / fine20), 3.5);
  // full integration locks: this is what mean dilatation is for
  EXPECT_GE(sphere_error(Element::hex8, 8, .4999), .9);
}

TEST(SlowThickSphere, ReachesThreeParts1e5WithReducedQuadraticElements) {
  EXPECT_LE(sphere_error(Element::hex20r, 8, .4999), 3e-5);
  EXPECT_LE(sphere_error(Element::hex20r, 8, .3), 3e-5);
}

}  // namespace
}  // namespace face
