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

// two stripes, one of cloth, and a line of paint: edges are cut, halved and cut again
mesh::Skin cut_and_lifted() {
  mesh::Garment cloth = slab("cloth", 0.6, 0.823);
  cloth.thickness = 0.01;
  mesh::Garment line;
  line.name = "line";
  line.lines.resize(2, 4);
  line.lines << 0, 0.1, 0.1, 0.008, 0.06, 0.52, 0.08, 0.008;
  return *mesh::dress(skin(), {slab("stripe", 0.311, 0.4777), cloth, line});
}

TEST(Dress, TellsOfWhichVerticesEachIsMade) {
  const mesh::Skin bare = skin();
  const mesh::Skin dressed = cut_and_lifted();
  const mesh::Origin& origin = dressed.origin;
  ASSERT_EQ(origin.size(), static_cast<std::size_t>(dressed.surface.V.rows()));
  EXPECT_EQ(origin.older, bare.surface.V.rows());
  EXPECT_GT(origin.size(), static_cast<std::size_t>(origin.older));
  for (std::size_t v = 0; v < origin.size(); ++v) {
    float sum = 0, height = 0;
    for (int i = origin.first[v]; i < origin.first[v + 1]; ++i) {
      EXPECT_GT(origin.share[i], 0);
      sum += origin.share[i];
      height += origin.share[i] * bare.surface.V(origin.vertex[i], 1);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    // roundness and cloth go outward, along the tube's level normals (its flat ends aside): the height is that of the
    // mix
    if (height > 0.04 && height < 0.96) {
      EXPECT_NEAR(height, dressed.surface.V(static_cast<Eigen::Index>(v), 1), 1e-4);
    }
  }
}

TEST(Dress, WhatIsCutGoesAlongWithWhatIsMoved) {
  const mesh::Skin bare = skin();
  const mesh::Skin dressed = cut_and_lifted();
  // every vertex goes sideways by its height, so each new one must too; a follower of some moves no other
  std::vector<std::int64_t> moved;
  std::vector<double> by;
  for (Eigen::Index v = 0; v < bare.surface.V.rows(); ++v) {
    if (bare.surface.V(v, 1) < 0.05 || bare.surface.V(v, 1) > 0.95) continue;
    moved.push_back(v);
    by.insert(by.end(), {0.5 * bare.surface.V(v, 1), 0, 0});
  }
  const auto follower = mesh::Follower::of(dressed.origin, moved);
  ASSERT_TRUE(follower) << follower.error().sentence;
  EXPECT_EQ(follower->moved(), moved.size());
  Eigen::MatrixX3f V = dressed.surface.V;
  follower->add(by.data(), V);
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    const double y = dressed.surface.V(v, 1);
    const bool moves =
        std::binary_search(follower->vertices().begin(), follower->vertices().end(), static_cast<int>(v));
    const Eigen::RowVector3f by_v = V.row(v) - dressed.surface.V.row(v);
    if (!moves) {
      EXPECT_EQ(by_v.norm(), 0);
    } else if (y > 0.1 && y < 0.9) {
      EXPECT_NEAR(by_v.x(), 0.5 * y, 1e-4);
      EXPECT_EQ(by_v.y(), 0);
    }
  }
}

TEST(Dress, AFollowerOfNoVertexOrOfOneTwiceIsRefused) {
  const mesh::Origin origin = mesh::own_origin(5);
  for (const std::vector<std::int64_t>& moved : {std::vector<std::int64_t>{0, 5}, {-1}, {3, 1, 3}}) {
    const auto follower = mesh::Follower::of(origin, moved);
    ASSERT_FALSE(follower);
    EXPECT_EQ(follower.error().kind, "range");
  }
  EXPECT_TRUE(mesh::Follower::of(origin, {})->vertices().empty());
  EXPECT_EQ(mesh::Follower::of(origin, {4, 0})->vertices(), (std::vector<int>{0, 4}));
}

TEST(Dress, APatchMadeAnewHasTheBitsOfTheWhole) {
  const mesh::Skin dressed = cut_and_lifted();
  const Eigen::Isometry3d X = Eigen::Translation3d(0.1, 0, 0) * Eigen::AngleAxisd(1, Vector3d::UnitZ());
  const std::vector<Eigen::Isometry3d> pose = {Eigen::Isometry3d::Identity(), X};
  const auto follower = mesh::Follower::of(dressed.origin, {400, 401, 402, 433, 434, 640});
  const mesh::Patch patch = mesh::patch_around(dressed.surface.F, dressed.weld, follower->vertices());
  EXPECT_LT(patch.faces.size(), static_cast<std::size_t>(dressed.surface.F.rows()) / 4);
  const std::vector<double> by = {0.01, 0, 0, 0, 0.02, 0, 0, 0, 0.01, 0.01, 0.01, 0, 0, 0, 0.03, 0.02, 0, 0};
  Eigen::MatrixX3f rest = dressed.surface.V;
  follower->add(by.data(), rest);
  for (mesh::Blend blend : {mesh::Blend::dual_quaternion, mesh::Blend::linear}) {
    Eigen::MatrixX3f V, N, V_whole, N_whole;
    mesh::deform(dressed, pose, V, N, blend);
    mesh::deform(dressed, rest, pose, V_whole, N_whole, blend);
    EXPECT_NE(V, V_whole);
    mesh::deform_patch(dressed, rest, pose, patch, V, N, blend);
    EXPECT_EQ(V, V_whole);
    EXPECT_EQ(N, N_whole);
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
