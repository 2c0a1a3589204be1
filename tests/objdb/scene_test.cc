#include "objdb/scene/scene.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/objdb/world.h"

namespace objdb::scene {
namespace {

constexpr double pi = std::numbers::pi;

// a few roundings of numbers of size 1
constexpr double rounding = 1e-14;

void expect_near(const Transform& a, const Transform& b, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(a.p[i], b.p[i], tolerance);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(a.R[i][j], b.R[i][j], tolerance);
  }
}

Quat about(std::size_t axis, double angle) {
  Quat q{std::cos(angle / 2), 0, 0, 0};
  q[axis + 1] = std::sin(angle / 2);
  return q;
}

TEST(Transform, TurnsTheAxesRightHanded) {
  // a quarter turn about x takes y to z, about y z to x, about z x to y
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Transform turn = from_pose({0, 0, 0}, about(axis, pi / 2));
    Vec3 from{0, 0, 0}, to{0, 0, 0};
    from[(axis + 1) % 3] = 1;
    to[(axis + 2) % 3] = 1;
    const Vec3 got = turn * from;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(got[i], to[i], rounding);
  }
}

TEST(Transform, WithItsInverseIsNothing) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10'000; ++i) {
    const Transform x = from_pose({normal(random), normal(random), normal(random)},
                                  {normal(random), normal(random), normal(random), normal(random)});
    expect_near(x * inverse(x), {}, rounding);
    expect_near(inverse(x) * x, {}, rounding);
    const Vec3 point{normal(random), normal(random), normal(random)};
    const Transform y = from_pose(point, {normal(random), normal(random), normal(random), normal(random)});
    const Vec3 together = (x * y) * point, one_by_one = x * (y * point);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(together[k], one_by_one[k], rounding * 10);
  }
}

// the worst places of the conversion are half turns, where w is 0, and the borders between its four branches
TEST(Transform, GivesItsQuaternionBackForEveryAngle) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100'000; ++i) {
    Vec3 axis{normal(random), normal(random), normal(random)};
    if (i % 3 == 0) axis[random() % 3] *= 1e-9;
    if (i % 5 == 0) axis[random() % 3] = 0;
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    const double near_half = pi * (1 - std::pow(10.0, -static_cast<double>(random() % 17)));
    const double angle = i % 2 == 0 ? near_half : std::uniform_real_distribution<double>(-pi, pi)(random);
    Quat q{std::cos(angle / 2), 0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) q[k + 1] = std::sin(angle / 2) * axis[k] / length;
    const Quat back = quaternion(from_pose({0, 0, 0}, q));
    EXPECT_GE(back[0], 0);
    double dot = 0, norm = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      dot += q[k] * back[k];
      norm += back[k] * back[k];
    }
    ASSERT_NEAR(norm, 1, rounding);
    // q and -q are the same turn
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(back[k], dot < 0 ? -q[k] : q[k], rounding);
  }
}

TEST(Transform, NeedsNoUnitQuaternion) {
  const Transform expected = from_pose({1, 2, 3}, {0.5, 0.5, -0.5, 0.5});
  for (const double scale : {1e-320, 1e-300, 1e-160, 1e-3, 2.0, 1e160, 1e300, 1e308}) {
    const Transform got = from_pose({1, 2, 3}, {scale, scale, -scale, scale});
    expect_near(got, expected, rounding);
  }
  expect_near(from_pose({0, 0, 0}, {5e-324, 0, 0, 0}), {}, 0);
  expect_near(from_pose({0, 0, 0}, {1.7e308, 1.7e308, 0, 0}), from_pose({0, 0, 0}, about(0, pi / 2)), rounding);
}

TEST(DenavitHartenberg, IsItsFourSteps) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-4, 4);
  for (int i = 0; i < 1000; ++i) {
    const double theta = any(random), d = any(random), a = any(random), alpha = any(random);
    const Transform steps = from_pose({0, 0, 0}, about(2, theta)) * from_pose({0, 0, d}, {1, 0, 0, 0}) *
                            from_pose({a, 0, 0}, {1, 0, 0, 0}) * from_pose({0, 0, 0}, about(0, alpha));
    expect_near(denavit_hartenberg(theta, d, a, alpha), steps, rounding * 10);
  }
}

// a planar arm of two links, the textbook's closed form
TEST(Joint, ChainReachesWhereTrigonometrySays) {
  World world;
  ASSERT_EQ(
      world.read(
          "create joint base dh 0 0 2 0\ncreate joint elbow parent base dh 0 0 1 0\ncreate node hand parent elbow\n"),
      "");
  for (double a = -3; a < 3; a += 0.37)
    for (double b = -3; b < 3; b += 0.41) {
      ASSERT_EQ(world.say("set base.angle " + number(a)), "");
      ASSERT_EQ(world.say("set elbow.angle " + number(b)), "");
      const Vec3& p = world.database.scene().world(*world.database.find("hand")).p;
      EXPECT_NEAR(p[0], 2 * std::cos(a) + std::cos(a + b), rounding);
      EXPECT_NEAR(p[1], 2 * std::sin(a) + std::sin(a + b), rounding);
      EXPECT_EQ(p[2], 0);
    }
}

TEST(Scene, LetsThePathCarryUnlessAParentIsNamed) {
  World world;
  ASSERT_EQ(world.read("type note\ncreate node a position 1 0 0\ncreate note a/n\ncreate node a/n/b position 0 1 0\n"
                       "create node c position 0 0 5\n"),
            "");
  EXPECT_EQ(world.get("a/n/b.world_position"), "1 1 0") << "through what is no node";
  ASSERT_EQ(world.say("set a/n/b.parent c"), "");
  EXPECT_EQ(world.get("a/n/b.world_position"), "0 1 5");
  ASSERT_EQ(world.say("set c.orientation 0 0 0 1"), "");
  EXPECT_EQ(world.get("a/n/b.world_position"), "0 -1 5");
  ASSERT_EQ(world.say("set a/n/b.parent -"), "");
  EXPECT_EQ(world.get("a/n/b.world_position"), "1 1 0");
  ASSERT_EQ(world.say("set a.scale 2 2 2"), "");
  EXPECT_EQ(world.get("a/n/b.world_position"), "1 1 0") << "scale is of the drawing alone";
}

TEST(Scene, RefusesCircles) {
  World world;
  ASSERT_EQ(
      world.read("create node a\ncreate node a/b\ncreate node a/b/c\ncreate node d parent a/b/c\ncreate node e\n"), "");
  const std::uint64_t before = world.database.hash();
  for (const char* line : {"set a.parent a", "set a.parent a/b", "set a.parent a/b/c", "set a.parent d",
                           "set a/b.parent d", "set a/b.parent a/b/c", "set d.parent d", "set **.parent d"}) {
    EXPECT_EQ(world.say(line).substr(0, 6), "range ") << line;
    EXPECT_EQ(world.database.hash(), before) << line;
  }
  // away from a by reference, then a below it: now it cannot come back to a by its path
  ASSERT_EQ(world.read("set a/b.parent e\nset a.parent d\n"), "");
  EXPECT_EQ(world.say("set a/b.parent -").substr(0, 6), "range ");
  EXPECT_EQ(world.get("a/b.parent"), "e");
  // nor when e goes: then a lets go of d
  EXPECT_EQ(world.say("delete e").substr(0, 5), "busy ");
  ASSERT_EQ(world.say("delete e force"), "");
  EXPECT_EQ(world.get("a/b.parent"), "-");
  EXPECT_EQ(world.get("a.parent"), "-");
  EXPECT_EQ(world.get("d.parent"), "a/b/c");
  EXPECT_EQ(world.get("d.world_position"), "0 0 0");
}

TEST(Scene, SaysSavedParentsInAnOrderThatIsLegal) {
  World world;
  ASSERT_EQ(world.read("create node a\ncreate node a/b\ncreate node c\nset a/b.parent c\nset a.parent a/b\n"), "");
  World other;
  ASSERT_EQ(other.read(save(world.database)), "");
  EXPECT_EQ(other.database.hash(), world.database.hash());
}

TEST(Scene, HoldsNeitherInfinityNorNotANumber) {
  World world;
  ASSERT_EQ(world.read("create node a position 1.7e308 -1.7e308 1e308\n"
                       "create node a/b position 1.7e308 1.7e308 1e308 orientation 1e308 1e308 1e308 1e308\n"
                       "create joint a/b/c dh 1.7e308 1.7e308 1.7e308 1e308 angle 1.7e308 position 1e308 1e308 1e308\n"
                       "create node a/b/c/d position -1.7e308 1.7e308 1e308\n"),
            "");
  for (const char* path : {"a", "a/b", "a/b/c", "a/b/c/d"}) {
    const Transform& world_frame = world.database.scene().world(*world.database.find(path));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(std::isfinite(world_frame.p[i])) << path;
      double norm = 0;
      for (std::size_t j = 0; j < 3; ++j) norm += world_frame.R[j][i] * world_frame.R[j][i];
      EXPECT_NEAR(norm, 1, rounding) << path;
    }
    const std::string printed =
        world.get(std::string(path) + ".world_position") + world.get(std::string(path) + ".world_orientation");
    EXPECT_EQ(printed.find_first_of("if"), std::string::npos) << printed;
  }
  EXPECT_EQ(world.get("a/b.world_position"), "1.7976931348623157e+308 0 1.7976931348623157e+308");
}

TEST(Scene, CarriesAChainOfAHundredThousand) {
  World world;
  const int depth = 100'000;
  ASSERT_EQ(world.say("create node n0 position 0 0 1"), "");
  for (int i = 1; i < depth; ++i)
    ASSERT_EQ(world.say("create node n" + std::to_string(i) + " position 0 0 1 parent n" + std::to_string(i - 1)), "");
  const std::string last = "n" + std::to_string(depth - 1);
  EXPECT_EQ(world.get(last + ".world_position"), "0 0 " + number(depth));
  ASSERT_EQ(world.say("set n0.position 0 0 2"), "");
  EXPECT_EQ(world.get(last + ".world_position"), "0 0 " + number(depth + 1));
  EXPECT_EQ(world.say("set n0.parent " + last).substr(0, 5), "range");
  World other;
  ASSERT_EQ(other.read(save(world.database)), "");
  EXPECT_EQ(other.get(last + ".world_position"), "0 0 " + number(depth + 1));
  ASSERT_EQ(world.say("delete n* force"), "");
  EXPECT_EQ(world.database.size(), 0u);
}

// what is derived is told when it changes after somebody looked at it, of everything below
TEST(Scene, TellsOfEveryFrameThatMoved) {
  World world;
  ASSERT_EQ(world.read("create node a\ncreate node a/b\ncreate node a/c\ncreate node d\ncreate node e parent a/c\n"),
            "");
  Database& database = world.database;
  const Database::FeedId feed = database.subscribe();
  const auto moved = [&] {
    std::string out;
    database.read_feed(feed, [&](const Database::Event& event, const Object& object) {
      if (event.field == Scene::world_position) {
        out += object.path + " ";
        database.value(object, Scene::world_position);
      }
    });
    return out;
  };
  world.everything();
  ASSERT_EQ(world.say("set a.position 1 0 0"), "");
  EXPECT_EQ(moved(), "a a/b a/c e ");
  ASSERT_EQ(world.say("set a/c.orientation 0 1 0 0"), "");
  ASSERT_EQ(world.say("set a/c.position 0 1 0"), "");
  EXPECT_EQ(moved(), "a/c e ");
  ASSERT_EQ(world.say("set e.parent d"), "");
  EXPECT_EQ(moved(), "e ");
  ASSERT_EQ(world.say("set a.visible false"), "");
  EXPECT_EQ(moved(), "");
  ASSERT_EQ(world.say("set a.position 1 0 0"), "");
  EXPECT_EQ(moved(), "") << "the same bits are no change";
}

TEST(Ids, RiseInTheirList) {
  std::vector<ObjectId> ids;
  for (const ObjectId id : {5u, 1u, 9u, 3u}) insert_id(ids, id);
  EXPECT_EQ(ids, (std::vector<ObjectId>{1, 3, 5, 9}));
  erase_id(ids, 3);
  erase_id(ids, 4);
  EXPECT_EQ(ids, (std::vector<ObjectId>{1, 5, 9}));
}

}  // namespace
}  // namespace objdb::scene
