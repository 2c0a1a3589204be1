#include "manipulators/mesh/surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "manipulators/mesh/normals.h"
#include "manipulators/mesh/topology.h"
#include "manipulators/mesh/tree.h"
#include "tests/manipulators/mesh/surfaces.h"

namespace {

TEST(Topology, CubeIsClosedAndHasItsAreaAndVolume) {
  const mesh::Topology t = mesh::topology(known::cube());
  EXPECT_EQ(t.components, 1);
  EXPECT_TRUE(t.closed());
  EXPECT_TRUE(t.manifold());
  EXPECT_EQ(t.euler, 2);
  EXPECT_DOUBLE_EQ(t.area, 6);
  EXPECT_DOUBLE_EQ(t.volume, 1);
}

TEST(Topology, OpenCubeShowsItsBoundaryLoop) {
  mesh::Surface cube = known::cube();
  std::vector<bool> keep(12, true);
  keep[0] = keep[1] = false;  // the side z = 0
  const mesh::Surface open = mesh::subset(cube, keep);
  EXPECT_EQ(mesh::topology(open).boundary_edges, 4);
  const auto loops = mesh::boundary_loops(open);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].size(), 4U);
}

TEST(Topology, CountsWhatIsWrong) {
  mesh::Surface cube = known::cube();
  std::swap(cube.F(0, 0), cube.F(0, 1));  // one face inside out
  EXPECT_EQ(mesh::topology(cube).misoriented_edges, 3);
  EXPECT_FALSE(mesh::topology(cube).manifold());

  // a third face on an edge
  mesh::Surface fin =
      known::of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  EXPECT_EQ(mesh::topology(fin).nonmanifold_edges, 1);
}

TEST(Surface, AppendJoinsPartsOfOneNameAndSubsetUndoesIt) {
  mesh::Surface both = known::cube();
  mesh::Surface other = known::sphere(2, 8, 12);
  other.V.col(0).array() += 5;
  other.part_names = {"ball"};
  mesh::append(both, other);
  EXPECT_EQ(both.part_names, (std::vector<std::string>{"skin", "ball"}));
  EXPECT_EQ(mesh::topology(both).components, 2);
  EXPECT_EQ(both.N.rows(), both.V.rows());

  std::vector<bool> keep;
  for (int part : both.part) keep.push_back(part == 1);
  std::vector<int> map;
  const mesh::Surface ball = mesh::subset(both, keep, &map);
  ASSERT_EQ(ball.V.rows(), other.V.rows());
  for (Eigen::Index v = 0; v < ball.V.rows(); ++v) EXPECT_EQ(ball.V.row(v), other.V.row(map[v] - 8));
}

TEST(Normals, OfASpherePointOutward) {
  const mesh::Surface sphere = known::sphere(0.3);
  // the faces are flat: the mean of their normals misses the sphere's by at most their size, a twelfth of a turn / 4
  for (Eigen::Index v = 0; v < sphere.V.rows(); ++v) {
    EXPECT_GT(sphere.N.row(v).dot(sphere.V.row(v).normalized()), 0.995F) << v;
  }
}

TEST(Normals, VerticesOnTopOfEachOtherShareOne) {
  // two faces of a roof that share no vertex
  const mesh::Surface roof =
      known::of({{0, 0, 0}, {0, 0, 1}, {-1, -1, 0}, {0, 0, 1}, {0, 0, 0}, {1, -1, 0}}, {{0, 2, 1}, {3, 5, 4}});
  EXPECT_EQ(roof.N.row(0), roof.N.row(4));
  EXPECT_NEAR(roof.N(0, 1), 1, 1e-6);
  EXPECT_EQ(mesh::welded(roof.V)[4], 0);
}

TEST(Normals, AreFiniteForFacesWithoutArea) {
  const mesh::Surface flat = known::of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}});
  EXPECT_TRUE(flat.N.allFinite());
  EXPECT_EQ(flat.N(0, 1), 1);
}

TEST(Tree, MeetsASphereWhereGeometrySaysSo) {
  const mesh::Surface sphere = known::sphere(1, 64, 96);
  const mesh::Tree tree(sphere.V, sphere.F);
  for (int i = 0; i < 50; ++i) {
    const double y = -0.9 + 1.8 * i / 49, z = 0.3 * std::sin(i);
    if (y * y + z * z > 0.95) continue;
    const Eigen::Vector3d a(-2, y, z), b(2, y, z);
    const auto hits = tree.hits(a, b);
    ASSERT_GE(hits.size(), 2U);
    // flat faces lie inside the sphere by at most 1 - cos(half a face) = 1.3e-3, seen at a slant of at most 70 degrees
    EXPECT_NEAR(-2 + 4 * hits.front().share, -std::sqrt(1 - y * y - z * z), 6e-3);
    EXPECT_EQ(tree.first_hit(a, b).share, hits.front().share);
  }
  EXPECT_EQ(tree.first_hit({-2, 1.1, 0}, {2, 1.1, 0}).face, -1);
  EXPECT_EQ(tree.first_hit({-0.5, 0, 0}, {0.5, 0, 0}).face, -1);
}

TEST(Tree, AgreesWithTryingEveryFace) {
  const mesh::Surface tube = known::tube(1, 0.2);
  const mesh::Tree tree(tube.V, tube.F);
  // ends of the lines from a fixed recurrence, all over the box
  double x = 0.37;
  const auto next = [&] { return x = std::fmod(7.13 * x + 0.217, 1.0); };
  int met = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d a(next() - 0.5, 1.4 * next() - 0.2, next() - 0.5),
        b(next() - 0.5, 1.4 * next() - 0.2, next() - 0.5);
    double least = 1;
    for (Eigen::Index f = 0; f < tube.F.rows(); ++f) {
      const auto corner = [&](int c) -> Eigen::Vector3d { return tube.V.row(tube.F(f, c)).transpose().cast<double>(); };
      const Eigen::Vector3d p = corner(0), q = corner(1), r = corner(2);
      // a + t (b - a) = p + u (q - p) + v (r - p)
      Eigen::Matrix3d A;
      A << a - b, q - p, r - p;
      if (std::abs(A.determinant()) < 1e-14) continue;
      const Eigen::Vector3d tuv = A.inverse() * (a - p);
      if (tuv[0] > 0 && tuv[1] >= 0 && tuv[2] >= 0 && tuv[1] + tuv[2] <= 1) least = std::min(least, tuv[0]);
    }
    met += least < 1;
    EXPECT_NEAR(tree.first_hit(a, b).share, least, 1e-9) << i;
  }
  EXPECT_GT(met, 5);
}

}  // namespace
