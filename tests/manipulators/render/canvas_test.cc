#include "manipulators/render/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "manipulators/render/cull.h"
#include "manipulators/render/shapes.h"

namespace render {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr Size small{320, 240};

// one canvas for all tests: making one compiles every shader
Canvas& canvas() {
  static std::string problem;
  static std::unique_ptr<Canvas> the_canvas = Canvas::make(problem);
  EXPECT_TRUE(the_canvas) << problem;
  return *the_canvas;
}

Drawable ball(const Eigen::Vector3f& at, float radius, const Eigen::Vector3f& color) {
  Drawable drawable;
  drawable.geometry = unit_sphere();
  drawable.X_WG.translate(at).scale(radius);
  drawable.materials[0].color = color;
  return drawable;
}

// unlit, so that colours come out as they went in
Drawable flat_ball(const Eigen::Vector3f& at, float radius, const Eigen::Vector3f& color) {
  Drawable drawable = ball(at, radius, color);
  drawable.materials[0].finish = Finish::unlit;
  drawable.casts_shadow = false;
  return drawable;
}

Scene empty_scene() {
  Scene scene;
  scene.lights = three_point_lights();
  scene.surroundings.ground = Ground::none;
  return scene;
}

Picture drawn(const Scene& scene, const Camera& camera, Quality quality = Quality::draft, Size size = small) {
  Picture picture;
  EXPECT_EQ(canvas().draw(scene, camera, size, quality, picture), "");
  return picture;
}

struct Blob {
  double x = 0, y = 0;
  int area = 0;
};

// centre (pixel edges at integers) and area of the pixels that are mostly red
Blob red_blob(const Picture& picture) {
  Blob blob;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Rgba p = picture.at(x, y);
      if (p[0] > 200 && p[1] < 60 && p[2] < 60) {
        blob.x += x + 0.5;
        blob.y += y + 0.5;
        ++blob.area;
      }
    }
  }
  blob.x /= std::max(blob.area, 1);
  blob.y /= std::max(blob.area, 1);
  return blob;
}

int luma(Rgba p) { return (p[0] + p[1] + p[2]) / 3; }

const Eigen::Vector3f red(1, 0, 0);

TEST(Canvas, ProjectsAsThePinholeFormulaSays) {
  Scene scene = empty_scene();
  const Eigen::Vector3f at(0.3f, 0.2f, 5);
  scene.drawables.push_back(flat_ball(at, 0.25f, red));
  Camera camera;  // at the origin, looking along +Z
  camera.field_of_view = 0.8f;
  const Blob blob = red_blob(drawn(scene, camera));
  const double focal = small.height / 2 / std::tan(0.4);
  // facing +Z, +X is on the left and +Y up; 0.15 pixel of rasterization noise on a disc of 14 pixels radius
  EXPECT_NEAR(blob.x, small.width / 2 - focal * at.x() / at.z(), 0.15);
  EXPECT_NEAR(blob.y, small.height / 2 - focal * at.y() / at.z(), 0.15);
  // a ball at this distance covers pi (f r)^2 / (z^2 - r^2) to first order off the axis; 3 % for the facets and pixels
  EXPECT_NEAR(blob.area / (pi * std::pow(focal * 0.25, 2) / (25 - 0.0625)), 1, 0.03);
}

TEST(Canvas, NearerHidesFarther) {
  Scene scene = empty_scene();
  scene.drawables.push_back(flat_ball({0, 0, 3}, 0.3f, {0, 0, 1}));
  scene.drawables.push_back(flat_ball({0, 0, 5}, 0.3f, red));
  EXPECT_EQ(red_blob(drawn(scene, Camera())).area, 0);
  scene.drawables[1].on_top = true;
  EXPECT_GT(red_blob(drawn(scene, Camera())).area, 100);
}

TEST(Canvas, KeyLightThrowsTheShadowWhereItsRaysGo) {
  Scene scene = empty_scene();
  scene.lights.resize(1);
  scene.lights[0].toward = Eigen::Vector3f(1, 2, 0).normalized();
  scene.surroundings.ground = Ground::studio;
  scene.drawables.push_back(ball({0, 1, 0}, 0.3f, {0.5f, 0.5f, 0.5f}));
  Camera camera;
  camera.X_WC = looking_at({0, 4, -4}, {0, 0, 0});
  const Picture with = drawn(scene, camera);
  scene.drawables[0].casts_shadow = false;
  const Picture without = drawn(scene, camera);
  // the ray through the ball's centre meets the ground at (-0.5, 0, 0)
  const Eigen::Matrix4f clip = view_projection(camera, 320.0f / 240);
  auto pixel = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector4f c = clip * Eigen::Vector4f(p.x(), p.y(), p.z(), 1);
    return Eigen::Vector2f((c.x() / c.w() + 1) * 160, (1 - c.y() / c.w()) * 120);
  };
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  int count = 0;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      // the ball itself covers 20 pixels about its centre and has a shadow side too
      const Eigen::Vector2f at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      if ((at - pixel({0, 1, 0})).norm() < 30 || luma(without.at(x, y)) - luma(with.at(x, y)) < 25) continue;
      centre += at;
      ++count;
    }
  }
  ASSERT_GT(count, 100);
  centre /= static_cast<float>(count);
  // its edge is soft and perspective shifts the middle of an ellipse: two pixels
  EXPECT_NEAR((centre - pixel({-0.5f, 0, 0})).norm(), 0, 2.0f);
}

TEST(Canvas, SideTowardTheLightIsBrighter) {
  Scene scene = empty_scene();
  scene.lights.resize(1);
  scene.lights[0].toward = Eigen::Vector3f(1, 0, -0.3f).normalized();  // from the left of the picture
  scene.drawables.push_back(ball({0, 0, 4}, 1, {0.6f, 0.6f, 0.6f}));
  const Picture picture = drawn(scene, Camera(), Quality::good);
  EXPECT_GT(luma(picture.at(110, 120)), luma(picture.at(210, 120)) + 40);
}

TEST(Canvas, SameSceneSameBytesEvenOnAnotherCanvas) {
  Scene scene = empty_scene();
  scene.surroundings.ground = Ground::grid;
  for (int i = 0; i < 5; ++i) {
    scene.drawables.push_back(ball({static_cast<float>(i) * 0.5f - 1, 0.3f, 4}, 0.3f, {0.2f * i, 0.5f, 0.7f}));
  }
  std::string problem;
  auto other = Canvas::make(problem);
  ASSERT_TRUE(other) << problem;
  for (Quality quality : {Quality::draft, Quality::good}) {
    const Picture a = drawn(scene, Camera(), quality);
    Picture b;
    ASSERT_EQ(other->draw(scene, Camera(), small, quality, b), "");
    EXPECT_TRUE(std::equal(a.data(), a.data() + a.byte_count(), b.data()));
  }
}

TEST(Canvas, QualitiesShowTheSameThing) {
  Scene scene = empty_scene();
  scene.surroundings.ground = Ground::studio;
  scene.drawables.push_back(ball({0, 0.3f, 3}, 0.3f, {0.7f, 0.3f, 0.2f}));
  Camera camera;
  camera.X_WC.translation() = Eigen::Vector3f(0, 0.5f, 0);
  const Picture good = drawn(scene, camera, Quality::good);
  const Difference best = difference(good, drawn(scene, camera, Quality::best));
  const Difference draft = difference(good, drawn(scene, camera, Quality::draft));
  // finer shadows and edges change little; the draft lacks contact shadows
  EXPECT_LT(best.mean, 0.5);
  EXPECT_LT(draft.mean, 2.0);
}

TEST(Canvas, ClearThingsLetThingsBehindThrough) {
  Scene scene = empty_scene();
  scene.drawables.push_back(flat_ball({0, 0, 6}, 0.5f, red));
  Drawable pane = flat_ball({0, 0, 3}, 0.4f, {0, 0, 1});
  pane.materials[0].opacity = 0.5f;
  scene.drawables.push_back(pane);
  const Rgba middle = drawn(scene, Camera()).at(160, 120);
  EXPECT_NEAR(middle[0], 128, 4);
  EXPECT_NEAR(middle[2], 128, 4);
}

TEST(Canvas, EyeShowsItsIrisWhereItLooks) {
  Scene scene = empty_scene();
  Drawable eye = ball({0, 0, 1}, 0.3f, {0.1f, 0.2f, 0.9f});
  eye.materials[0].finish = Finish::eye;
  // the camera looks along +Z, so an eye that looks at it looks along -Z
  eye.X_WG.linear() = Eigen::AngleAxisf(pi, Eigen::Vector3f::UnitY()).toRotationMatrix() * 0.3f;
  scene.drawables.push_back(eye);
  auto blue_pixels = [](const Picture& p) {
    int count = 0;
    double x = 0;
    for (int i = 0; i < p.width() * p.height(); ++i) {
      const Rgba c = p.at(i % p.width(), i / p.width());
      if (c[2] > c[0] + 60) {
        ++count;
        x += i % p.width() + 0.5;
      }
    }
    return std::pair(count, x / std::max(count, 1));
  };
  scene.surroundings.zenith = scene.surroundings.horizon = {0.5f, 0.5f, 0.5f};
  const auto [count, x] = blue_pixels(drawn(scene, Camera()));
  EXPECT_GT(count, 200);
  EXPECT_NEAR(x, 160, 3);
  const Rgba pupil = drawn(scene, Camera()).at(160, 120);
  EXPECT_LT(luma(pupil), 60);
  // turned to its own left (+Y rotation of an eye facing the viewer moves the iris to the right of the picture)
  scene.drawables[0].X_WG.linear() = Eigen::AngleAxisf(pi + 0.5f, Eigen::Vector3f::UnitY()).toRotationMatrix() * 0.3f;
  EXPECT_GT(blue_pixels(drawn(scene, Camera())).second, 180);
}

TEST(Canvas, RefusesImpossibleSizesInWords) {
  Picture picture;
  EXPECT_NE(canvas().draw(empty_scene(), Camera(), {0, 100}, Quality::good, picture), "");
  EXPECT_NE(canvas().draw(empty_scene(), Camera(), {100, 1 << 20}, Quality::good, picture), "");
  for (Size size : {Size{1, 1}, Size{1, 300}, Size{3, 2}}) {
    for (Quality quality : {Quality::draft, Quality::good, Quality::best}) {
      ASSERT_EQ(canvas().draw(empty_scene(), Camera(), size, quality, picture), "");
      EXPECT_EQ(picture.size(), size);
    }
  }
}

TEST(Canvas, DrawsFromInsideAThingAndWithNothingAtAll) {
  Scene scene = empty_scene();
  drawn(scene, Camera(), Quality::good);
  scene.lights.clear();
  scene.surroundings.ground = Ground::sea;
  scene.drawables.push_back(ball({0, 0, 0}, 2, {0.5f, 0.5f, 0.5f}));
  auto open = std::make_shared<Geometry>();
  scene.drawables.push_back({});
  scene.drawables.back().geometry = open;
  drawn(scene, Camera(), Quality::good);
}

TEST(Canvas, LabelsAreWritten) {
  Scene scene = empty_scene();
  scene.labels.push_back({"ball.position 0 1 2 \xc2\xb5 \xff", 10, 10});
  scene.labels.push_back({"lower right", -10, -10});
  const Picture plain = drawn(empty_scene(), Camera());
  const Picture written = drawn(scene, Camera());
  EXPECT_GT(difference(plain, written).worst, 5);
}

TEST(Cull, LeavesOutWhatCannotBeSeenAndCoarsensWhatIsFar) {
  Scene scene = empty_scene();
  scene.drawables.push_back(ball({0, 0, 5}, 0.5f, red));     // seen
  scene.drawables.push_back(ball({0, 0, -5}, 0.5f, red));    // behind
  scene.drawables.push_back(ball({50, 0, 5}, 0.5f, red));    // beside
  scene.drawables.push_back(ball({0, 0, 500}, 0.5f, red));   // beyond the far plane
  scene.drawables.push_back(ball({0, 0, 60}, 0.004f, red));  // smaller than a pixel
  scene.drawables.push_back(ball({5, 0, 90}, 0.8f, red));    // far
  const auto seen = seen_by(scene, Camera(), {640, 480});
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].drawable, 0u);
  EXPECT_EQ(seen[0].level, 0u);
  EXPECT_EQ(seen[1].drawable, 5u);
  EXPECT_GE(seen[1].level, 2u);
}

TEST(Cull, NeverLosesABoxThatHoldsAVisiblePoint) {
  Camera camera;
  camera.X_WC = looking_at({1, 2, 3}, {-2, 0.5f, 1});
  const Eigen::Matrix4f clip = view_projection(camera, 1.6f);
  const Frustum frustum(clip);
  std::uint32_t state = 12345;
  auto next = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 16777216.0f * 20 - 10;
  };
  int visible = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3f p(next(), next(), next());
    const Eigen::Vector4f c = clip * Eigen::Vector4f(p.x(), p.y(), p.z(), 1);
    const bool inside = c.w() > 0 && c.head<3>().cwiseAbs().maxCoeff() < c.w();
    Eigen::AlignedBox3f box(p);
    box.extend(p + Eigen::Vector3f(next(), next(), next()) * 0.1f);
    visible += inside;
    ASSERT_TRUE(!inside || frustum.touches(box));
  }
  EXPECT_GT(visible, 200);
}

}  // namespace
}  // namespace render
