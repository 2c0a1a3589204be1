#include "manipulators/mesh/dress.h"

#include <gtest/gtest.h>

#include "manipulators/mesh/topology.h"
#include "tests/manipulators/mesh/surfaces.h"

namespace {

using Eigen::Vector3d;

mesh::Skin skin() {
  mesh::Bone lower, upper;
  lower.name = "lower";
  lower.to = {0, 0.5, 0};
  lower.radius = upper.radius = 0.1;
  upper.name = "upper";
  upper.from = {0, 0.5, 0};
  upper.to = {0, 1, 0};
  return *mesh::bind_skin(known::tube(1, 0.1, 30, 32), {lower, upper});
}

mesh::Garment slab(const std::string& name, double low, double high) {
  mesh::Garment garment;
  garment.name = name;
  garment.planes.resize(2, 4);
  garment.planes << 0, 1, 0, -low, 0, -1, 0, high;
  return garment;
}

/// Area of a part, and the heights between which it lies.
struct Extent {
  double area = 0, low = 1e9, high = -1e9;
};

Extent extent(const mesh::Surface& surface, const std::string& name) {
  std::vector<bool> keep;
  for (int part : surface.part) keep.push_back(surface.part_names[part] == name);
  const mesh::Surface piece = mesh::subset(surface, keep);
  Extent result;
  if (piece.F.rows() > 0) {
    result.area = mesh::topology(piece).area;
    result.low = piece.V.col(1).minCoeff();
    result.high = piece.V.col(1).maxCoeff();
  }
  return result;
}

TEST(Dress, PaintHasStraightBordersAndTheRightArea) {
  const mesh::Skin bare = skin();
  const auto painted = mesh::dress(bare, {slab("stripe", 0.31, 0.47)});
  ASSERT_TRUE(painted) << painted.error().sentence;
  const Extent stripe = extent(painted->surface, "stripe");
  // a cut nearer than 3 % of an edge to a vertex goes through the vertex
  EXPECT_NEAR(stripe.low, 0.31, 0.03 / 29 + 1e-6);
  EXPECT_NEAR(stripe.high, 0.47, 0.03 / 29 + 1e-6);
  // the tube is a prism of 32 sides; new points lie on the round tube, so a little outside
  EXPECT_NEAR(stripe.area, 0.16 * 2 * M_PI * 0.1, 0.01 * stripe.area);
  EXPECT_TRUE(mesh::topology(painted->surface).closed());
  EXPECT_TRUE(mesh::topology(painted->surface).manifold());
  EXPECT_EQ(painted->surface.part_names, (std::vector<std::string>{"skin", "stripe"}));
}

TEST(Dress, WeightsOfNewVerticesAreMixed) {
  const auto painted = mesh::dress(skin(), {slab("stripe", 0.31, 0.487)});
  for (Eigen::Index v = 0; v < painted->weight.rows(); ++v) {
    EXPECT_NEAR(painted->weight.row(v).sum(), 1, 1e-5);
    EXPECT_GE(painted->weight.row(v).minCoeff(), 0);
  }
  // moving all bones alike still moves it rigidly
  const Eigen::Isometry3d X = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(1, Vector3d::UnitZ());
  Eigen::MatrixX3f V, N;
  mesh::deform(*painted, {X, X}, V, N);
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    EXPECT_LT((V.row(v).transpose().cast<double>() - X * painted->surface.V.row(v).transpose().cast<double>()).norm(),
              2e-6);
  }
}

TEST(Dress, ClothLiesAboveTheSkinAndIsClosed) {
  mesh::Garment sleeve = slab("sleeve", 0.3, 0.7);
  sleeve.thickness = 0.02;
  const auto dressed = mesh::dress(skin(), {sleeve});
  ASSERT_TRUE(dressed);
  // positions of rims coincide with those of cloth and skin: joined by position the surface is closed
  mesh::Surface joined = dressed->surface;
  const Eigen::VectorXi weld = mesh::welded(joined.V);
  for (Eigen::Index f = 0; f < joined.F.rows(); ++f) {
    for (int corner = 0; corner < 3; ++corner) joined.F(f, corner) = weld[joined.F(f, corner)];
  }
  const mesh::Topology t = mesh::topology(joined);
  EXPECT_TRUE(t.closed());
  EXPECT_TRUE(t.manifold());
  // the cloth is a shell of the given thickness and length around the tube
  const double shell = M_PI * (0.12 * 0.12 - 0.1 * 0.1) * 0.4;
  EXPECT_NEAR(t.volume - mesh::topology(skin().surface).volume, shell, 0.03 * shell);
}

TEST(Dress, BonesChooseTheSideWhereTheyHoldHalf) {
  mesh::Garment half;
  half.name = "upper_half";
  half.bones = {1};
  const auto dressed = mesh::dress(skin(), {half});
  const Extent extent_of_half = extent(dressed->surface, "upper_half");
  EXPECT_NEAR(extent_of_half.low, 0.5, 0.01);
  EXPECT_NEAR(extent_of_half.high, 1, 1e-6);
}

TEST(Dress, ALineIsAsWideAsItsBalls) {
  mesh::Garment line;
  line.name = "line";
  line.lines.resize(2, 4);
  line.lines << 0, 0.3, 0.1, 0.006, 0, 0.7, 0.1, 0.006;
  const auto dressed = mesh::dress(skin(), {line});
  const Extent extent_of_line = extent(dressed->surface, "line");
  // a strip 12 mm wide and 400 mm long with half a disc at each end, in triangles of half its width
  const double area = 0.4 * 0.012 + M_PI * 0.006 * 0.006;
  EXPECT_NEAR(extent_of_line.area, area, 0.05 * area);
  EXPECT_NEAR(extent_of_line.low, 0.294, 1e-3);
}

TEST(Dress, LaterGarmentsCoverEarlierOnes) {
  const auto dressed = mesh::dress(skin(), {slab("under", 0.2, 0.8), slab("over", 0.4, 0.6)});
  const double around = 2 * M_PI * 0.1;
  EXPECT_NEAR(extent(dressed->surface, "under").area, 0.4 * around, 0.01 * around);
  EXPECT_NEAR(extent(dressed->surface, "over").area, 0.2 * around, 0.01 * around);
}

TEST(Dress, FlareWidensTowardsTheHem) {
  mesh::Garment skirt = slab("skirt", 0.2, 0.8);
  skirt.thickness = 0.01;
  skirt.flare = {0, -0.5, 0, 0.25};  // from y = 0.5 down by half the way
  const auto dressed = mesh::dress(skin(), {skirt});
  double at_hem = 0, above = 0;
  for (Eigen::Index v = 0; v < dressed->surface.V.rows(); ++v) {
    const double r = std::hypot(dressed->surface.V(v, 0), dressed->surface.V(v, 2));
    const double y = dressed->surface.V(v, 1);
    if (std::abs(y - 0.2) < 1e-3) at_hem = std::max(at_hem, r);
    if (y > 0.55 && y < 0.75) above = std::max(above, r);
  }
  EXPECT_NEAR(at_hem, 0.1 + 0.01 + 0.15, 1e-3);
  EXPECT_NEAR(above, 0.11, 1e-3);
}

TEST(Dress, SmoothingLevelsABump) {
  mesh::Skin bare = skin();
  // one vertex stands out by 5 mm
  const Eigen::Index bump = 14 * 32 + 5;
  bare.surface.V.row(bump) += 0.005F * bare.surface.N.row(bump);
  mesh::Garment sleeve = slab("sleeve", 0.2, 0.8);
  sleeve.thickness = 0.02;
  const auto radius_at_bump = [&](int passes) {
    sleeve.smoothing = passes;
    const auto dressed = mesh::dress(bare, {sleeve});
    double most = 0;
    for (Eigen::Index v = 0; v < dressed->surface.V.rows(); ++v) {
      most = std::max<double>(most, std::hypot(dressed->surface.V(v, 0), dressed->surface.V(v, 2)));
    }
    return most;
  };
  EXPECT_NEAR(radius_at_bump(0), 0.125, 1e-3);
  EXPECT_LT(radius_at_bump(10), 0.1215);
}

TEST(Dress, BadGarmentsHaveOneClearError) {
  const mesh::Skin bare = skin();
  const auto fault = [&](const mesh::Garment& garment) {
    const auto dressed = mesh::dress(bare, {garment});
    return dressed ? "no error" : dressed.error().kind + " " + dressed.error().sentence;
  };
  mesh::Garment garment = slab("coat", 0, 1);
  garment.bones = {7};
  EXPECT_EQ(fault(garment), "range garment coat covers bone 7; the skin has bones 0 to 1");
  garment = slab("coat", 0, 1);
  garment.planes.row(1).setZero();
  EXPECT_EQ(fault(garment), "range garment coat: plane 2 has no direction");
  garment = slab("coat", 0, std::nan(""));
  EXPECT_EQ(fault(garment), "range garment coat needs finite planes, lines and thickness");
}

TEST(Dress, NothingOutsideTheSurfaceIsFine) {
  const mesh::Skin bare = skin();
  const auto dressed = mesh::dress(bare, {slab("hat", 5, 6)});
  ASSERT_TRUE(dressed);
  EXPECT_EQ(dressed->surface.F.rows(), bare.surface.F.rows());
  EXPECT_EQ(extent(dressed->surface, "hat").area, 0);
}

}  // namespace
