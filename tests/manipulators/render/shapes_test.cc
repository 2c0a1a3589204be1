#include "manipulators/render/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace render {
namespace {

constexpr double pi = std::numbers::pi;

// volume by the divergence theorem: positive when the triangles face outward
double volume(const Geometry& geometry, std::size_t level = 0) {
  double sum = 0;
  const auto& indices = geometry.levels[level].indices;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const Eigen::Vector3d a = geometry.vertices[indices[i]].position.cast<double>();
    const Eigen::Vector3d b = geometry.vertices[indices[i + 1]].position.cast<double>();
    const Eigen::Vector3d c = geometry.vertices[indices[i + 2]].position.cast<double>();
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

// edges, by position, that are not shared by exactly two triangles in opposite directions
int open_edges(const Geometry& geometry, std::size_t level = 0) {
  using Point = std::tuple<int, int, int>;
  auto key = [&](std::uint32_t v) {
    const Eigen::Vector3f p = geometry.vertices[v].position * 1e5f;
    return Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())),
                 static_cast<int>(std::lround(p.z())));
  };
  std::map<std::pair<Point, Point>, int> directed;
  const auto& indices = geometry.levels[level].indices;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const Point p[3] = {key(indices[i]), key(indices[i + 1]), key(indices[i + 2])};
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    for (int k = 0; k < 3; ++k) ++directed[{p[k], p[(k + 1) % 3]}];
  }
  int open = 0;
  for (const auto& [edge, count] : directed) {
    auto back = directed.find({edge.second, edge.first});
    open += back == directed.end() || back->second != count;
  }
  return open;
}

struct Body {
  const char* name;
  GeometryPointer geometry;
  double volume;
};

std::vector<Body> bodies() {
  return {
      {"sphere", unit_sphere(), 4 * pi / 3},
      {"box", unit_box(), 1},
      {"cylinder", unit_cylinder(), pi},
      {"cone", unit_cone(), pi / 3},
      {"capsule", capsule(0.5f, 2), pi * 0.25 * 2 + 4 * pi / 3 * 0.125},
      {"tube", tube({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, {0.3f, 0.3f, 0.3f}, {}, 24), pi * 0.09 * 2},
  };
}

TEST(Shapes, AreClosedAndFaceOutwardWithTheVolumeOfTheFormula) {
  for (const Body& body : bodies()) {
    EXPECT_EQ(open_edges(*body.geometry), 0) << body.name;
    EXPECT_TRUE(body.geometry->closed) << body.name;
    // inscribed polygons lose 2 pi^2 / (3 n^2) of a circle's area: 1.2 % at the fewest, 24 sides
    EXPECT_NEAR(volume(*body.geometry) / body.volume, 1, 0.015) << body.name;
    EXPECT_LE(volume(*body.geometry), body.volume * (1 + 1e-5)) << body.name;
  }
}

TEST(Shapes, HaveUnitNormalsThatPointOutward) {
  for (const Body& body : bodies()) {
    const Geometry& g = *body.geometry;
    const auto& indices = g.levels[0].indices;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      const Eigen::Vector3f& a = g.vertices[indices[i]].position;
      const Eigen::Vector3f face =
          (g.vertices[indices[i + 1]].position - a).cross(g.vertices[indices[i + 2]].position - a);
      if (face.norm() < 1e-7f) continue;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3f& normal = g.vertices[indices[i + k]].normal;
        ASSERT_NEAR(normal.norm(), 1, 1e-4) << body.name;
        if (std::string(body.name) == "tube") continue;  // its end discs borrow the mantle's normals
        ASSERT_GT(normal.dot(face.normalized()), 0.2f) << body.name;
      }
    }
  }
}

TEST(Shapes, SphereLevelsAreClosedAndAsCoarseAsTheySay) {
  const Geometry& sphere = *unit_sphere();
  ASSERT_EQ(sphere.levels.size(), 4u);
  for (std::size_t level = 0; level < 4; ++level) {
    EXPECT_EQ(open_edges(sphere, level), 0);
    // no vertex lies off the sphere, so the chord's sagitta bounds the error: the middle of each edge shows it
    float worst = 0;
    const auto& indices = sphere.levels[level].indices;
    for (std::size_t i = 0; i + 1 < indices.size(); i += 3) {
      const Eigen::Vector3f mid = (sphere.vertices[indices[i]].position + sphere.vertices[indices[i + 1]].position) / 2;
      worst = std::max(worst, 1 - mid.norm());
    }
    if (level > 0) {
      EXPECT_LE(worst, sphere.levels[level].error * 1.01f);
      EXPECT_LT(sphere.triangle_count(level), sphere.triangle_count(level - 1));
    }
  }
}

TEST(Shapes, SimplifiedLevelsStayWithinTheErrorTheyReport) {
  // a bumpy sphere of many triangles, whose radius is known in closed form everywhere
  auto geometry = std::make_shared<Geometry>(*unit_sphere());
  geometry->levels.resize(1);
  auto radius = [](const Eigen::Vector3f& d) { return 1 + 0.1f * std::sin(3 * d.x()) * std::cos(2 * d.y()); };
  for (Vertex& vertex : geometry->vertices) vertex.position *= radius(vertex.position.normalized());
  add_levels(*geometry);
  ASSERT_GE(geometry->levels.size(), 2u);
  for (std::size_t level = 1; level < geometry->levels.size(); ++level) {
    const Level& coarse = geometry->levels[level];
    EXPECT_LT(coarse.indices.size(), geometry->levels[level - 1].indices.size());
    float worst = 0;
    for (std::size_t i = 0; i < coarse.indices.size(); i += 3) {
      Eigen::Vector3f centre = Eigen::Vector3f::Zero();
      for (int k = 0; k < 3; ++k) centre += geometry->vertices[coarse.indices[i + k]].position / 3;
      worst = std::max(worst, std::abs(centre.norm() - radius(centre.normalized())));
    }
    // quadric errors are distances to planes of the original, which facets themselves miss by their sagitta;
    // three times the reported error holds that
    EXPECT_LT(worst, 3 * coarse.error + 0.01f) << level;
  }
}

TEST(Shapes, RecomputedNormalsOfASphereAreItsRadii) {
  Geometry sphere(*unit_sphere());
  recompute_normals(sphere);
  for (const Vertex& vertex : sphere.vertices) {
    // at the poles only slivers meet
    if (std::abs(vertex.position.z()) > 0.999f) continue;
    // the seam is open to one side: 0.1 rad covers the half facet it leans
    ASSERT_GT(vertex.normal.dot(vertex.position.normalized()), std::cos(0.1f));
  }
}

TEST(Shapes, HeatGrowsFromBlueToRedAndMarksWhatIsNoNumber) {
  EXPECT_GT(heat(0)[2], heat(0)[0]);
  EXPECT_GT(heat(1)[0], heat(1)[2]);
  EXPECT_EQ(heat(-5), heat(0));
  EXPECT_EQ(heat(7), heat(1));
  EXPECT_EQ(heat(std::nan("")), (std::array<std::uint8_t, 4>{128, 128, 128, 255}));
}

TEST(Shapes, TubeOfOnePointIsEmptyNotBroken) {
  EXPECT_TRUE(tube({{0, 0, 0}}, {1}, {})->vertices.empty());
  EXPECT_TRUE(segments({})->vertices.empty());
}

}  // namespace
}  // namespace render
