#include "manipulators/render/pick.h"

#include <gtest/gtest.h>

#include <cmath>

#include "manipulators/render/navigator.h"
#include "manipulators/render/shapes.h"

namespace render {
namespace {

Drawable body(GeometryPointer geometry, const Eigen::Vector3f& at, float size, std::string path) {
  Drawable drawable;
  drawable.geometry = std::move(geometry);
  drawable.X_WG.translate(at).scale(size);
  drawable.path = std::move(path);
  return drawable;
}

TEST(Pick, FindsTheNearestThingUnderThePixelThatShowsIt) {
  Scene scene;
  scene.drawables.push_back(body(unit_sphere(), {0, 0.3f, 0}, 0.2f, "ball"));
  scene.drawables.push_back(body(unit_box(), {0, 0.3f, -2}, 1, "crate"));
  Camera camera;
  camera.X_WC = looking_at({0, 0.5f, 3}, {0, 0, 0});
  camera.field_of_view = 0.7f;
  const Size size{640, 480};
  const Eigen::Matrix4f clip = view_projection(camera, 640.0f / 480);
  auto pixel = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector4f c = clip * Eigen::Vector4f(p.x(), p.y(), p.z(), 1);
    return Eigen::Vector2f((c.x() / c.w() + 1) * 320, (1 - c.y() / c.w()) * 240);
  };
  const Eigen::Vector2f at = pixel({0, 0.3f, 0});
  const auto hit = pick(scene, ray_through(camera, size, at.x(), at.y()));
  ASSERT_TRUE(hit);
  EXPECT_EQ(scene.drawables[hit->drawable].path, "ball");
  // on the sphere: facets lie at most 0.5 % of the radius inside
  EXPECT_NEAR((hit->point - Eigen::Vector3f(0, 0.3f, 0)).norm(), 0.2f, 0.0015f);
  EXPECT_NEAR((pixel(hit->point) - at).norm(), 0, 0.01f);

  const Eigen::Vector2f beside = pixel({0.4f, 0.5f, -1.5f});
  const auto behind = pick(scene, ray_through(camera, size, beside.x(), beside.y()));
  ASSERT_TRUE(behind);
  EXPECT_EQ(scene.drawables[behind->drawable].path, "crate");
  EXPECT_FALSE(pick(scene, ray_through(camera, size, 2, 2)));
}

TEST(Pick, IsNotMisledByTheSliversAtThePoles) {
  Scene scene;
  scene.drawables.push_back(body(unit_sphere(), {0, 0, 0}, 0.2f, "ball"));
  Camera camera;
  camera.X_WC = looking_at({0, 0, 3}, {0, 0, 0});
  const auto hit = pick(scene, ray_through(camera, {640, 480}, 320.2f, 240.1f));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.z(), 0.2f, 1e-3f);
}

TEST(Pick, OverlooksExplanationsAndThingsBehind) {
  Scene scene;
  scene.drawables.push_back(body(unit_sphere(), {0, 0, 2}, 0.5f, "cone"));
  scene.drawables[0].helper = true;
  scene.drawables.push_back(body(unit_sphere(), {0, 0, -2}, 0.5f, "behind"));
  EXPECT_FALSE(pick(scene, {{0, 0, 0}, {0, 0, 1}}));
}

TEST(Pick, CountsCrossingsOddFromInside) {
  const Drawable ball = body(unit_sphere(), {1, 2, 3}, 0.5f, "ball");
  const Eigen::Vector3f aside(0.31f, 0.52f, 0.77f);  // meets no edge
  EXPECT_EQ(crossings(ball, {{1.1f, 2.1f, 2.9f}, aside}) % 2, 1);
  EXPECT_EQ(crossings(ball, {{3, 2, 3}, aside}) % 2, 0);
}

TEST(Pick, ViewPlaneIsAsFarAsThePointOnIt) {
  Camera camera;
  camera.X_WC = looking_at({1, 2, 3}, {0, 0, 0});
  const Eigen::Vector3f point(0.2f, 0.1f, -0.3f);
  const auto where = on_view_plane(camera, ray_through(camera, {200, 100}, 30, 80), point);
  ASSERT_TRUE(where);
  EXPECT_NEAR((*where - point).dot(camera.X_WC.linear().col(2)), 0, 1e-5f);
  EXPECT_FALSE(on_view_plane(camera, {{1, 2, 3}, -camera.X_WC.linear().col(2)}, point));
}

TEST(Navigator, StartsWhereTheCameraIsAndKeepsItsCentre) {
  Camera camera;
  camera.X_WC = looking_at({1, 2, 3}, {0.5f, 1, 0});
  Navigator navigator;
  navigator.start(camera, 2);
  EXPECT_TRUE(navigator.camera().X_WC.isApprox(camera.X_WC, 1e-5f));
  const Eigen::Vector3f centre = navigator.centre();
  navigator.orbit(0.7f, 0.2f);
  const Camera turned = navigator.camera();
  EXPECT_NEAR((turned.X_WC.translation() - centre).norm(), 2, 1e-5f);
  EXPECT_NEAR(turned.X_WC.linear().col(2).cross(centre - turned.X_WC.translation()).norm(), 0, 1e-5f);
  navigator.zoom(0.5f);
  EXPECT_NEAR((navigator.camera().X_WC.translation() - centre).norm(), 1, 1e-5f);
  // any amount of upward turn stays short of the top, where left and right would swap
  for (int i = 0; i < 50; ++i) navigator.orbit(0, 0.3f);
  EXPECT_GT(navigator.camera().X_WC.linear().col(1).y(), 0);
}

TEST(Navigator, PanKeepsTheCentreUnderThePointer) {
  Camera camera;
  camera.X_WC = looking_at({0, 1, 4}, {0, 1, 0});
  const Size size{400, 300};
  Navigator navigator;
  navigator.start(camera, 4);
  const Eigen::Vector3f before = navigator.centre();
  navigator.pan(50, 20, size);
  // the old centre now lies 50 pixels right of and 20 below the middle of the picture
  const Eigen::Matrix4f clip = view_projection(navigator.camera(), 400.0f / 300);
  const Eigen::Vector4f c = clip * Eigen::Vector4f(before.x(), before.y(), before.z(), 1);
  EXPECT_NEAR((c.x() / c.w() + 1) * 200, 250, 0.1f);
  EXPECT_NEAR((1 - c.y() / c.w()) * 150, 170, 0.1f);
}

}  // namespace
}  // namespace render
