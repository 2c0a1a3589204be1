#include "manipulators/mesh/skin.h"

#include <gtest/gtest.h>

#include "manipulators/mesh/stand_in.h"
#include "manipulators/mesh/topology.h"
#include "tests/manipulators/mesh/surfaces.h"

namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

mesh::Bone bone(const std::string& name, const Vector3d& from, const Vector3d& to, double radius = 0.1) {
  mesh::Bone result;
  result.name = name;
  result.from = from;
  result.to = to;
  result.radius = radius;
  return result;
}

/// An arm of radius 0.1 along y from 0 to 1, its elbow in the middle.
mesh::Skin arm() {
  return *mesh::bind_skin(known::tube(1, 0.1, 60, 32),
                          {bone("upper", {0, 0.1, 0}, {0, 0.5, 0}), bone("lower", {0, 0.5, 0}, {0, 0.9, 0})});
}

Isometry3d turned_at(const Vector3d& point, double angle, const Vector3d& axis) {
  return Translation3d(point) * AngleAxisd(angle, axis) * Translation3d(-point);
}

double volume(const mesh::Surface& shape, const Eigen::MatrixX3f& V) {
  mesh::Surface moved = shape;
  moved.V = V;
  return mesh::topology(moved).volume;
}

/// Least distance from the line between p and q of the vertices whose rest height lies in [low, high].
double narrowest(const mesh::Skin& skin, const Eigen::MatrixX3f& V, double low, double high, const Vector3d& p,
                 const Vector3d& along) {
  double least = 1e9;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    const double y = skin.surface.V(v, 1);
    if (y >= low && y <= high) {
      least = std::min(least, (V.row(v).transpose().cast<double>() - p).cross(along).norm());
    }
  }
  return least;
}

TEST(Bind, WeightsArePositiveSumToOneAndFall) {
  const mesh::Skin skin = arm();
  for (Eigen::Index v = 0; v < skin.weight.rows(); ++v) {
    EXPECT_NEAR(skin.weight.row(v).sum(), 1, 1e-6);
    EXPECT_GE(skin.weight.row(v).minCoeff(), 0);
    EXPECT_GE(skin.weight(v, 0), skin.weight(v, 1));
  }
}

TEST(Bind, AreSymmetricAboutTheElbowAndChangeSmoothly) {
  const mesh::Skin skin = arm();
  const auto upper = [&](Eigen::Index v) {
    return skin.index(v, 0) == 0 ? skin.weight(v, 0) : (skin.index(v, 1) == 0 ? skin.weight(v, 1) : 0);
  };
  const int around = 32;
  for (int row = 0; row < 60; ++row) {
    // the bones mirror each other in y = 0.5; the triangles do not quite
    EXPECT_NEAR(upper(row * around), 1 - upper((59 - row) * around), 0.03) << row;
    if (row > 0) {
      EXPECT_LE(upper(row * around), upper((row - 1) * around) + 1e-3) << row;
      EXPECT_LT(std::abs(upper(row * around) - upper((row - 1) * around)), 0.25) << row;
    }
  }
  EXPECT_GT(upper(5 * around), 0.999);
}

TEST(Bind, NothingBleedsAcrossAGap) {
  // two fingers side by side, 2 cm of air between them: each follows its own bone alone
  mesh::Surface fingers = known::tube(1, 0.1);
  mesh::Surface other = known::tube(1, 0.1);
  other.V.col(0).array() += 0.22F;
  const Eigen::Index first = fingers.V.rows();
  mesh::append(fingers, other);
  const auto skin =
      mesh::bind_skin(fingers, {bone("one", {0, 0.1, 0}, {0, 0.9, 0}), bone("two", {0.22, 0.1, 0}, {0.22, 0.9, 0})});
  ASSERT_TRUE(skin);
  for (Eigen::Index v = 0; v < skin->weight.rows(); ++v) {
    EXPECT_EQ(skin->index(v, 0), v < first ? 0 : 1);
    EXPECT_NEAR(skin->weight(v, 0), 1, 1e-5);
  }
}

TEST(Bind, ABallInsideFollowsTheNearestBone) {
  mesh::Surface head = known::sphere(0.1);
  mesh::Surface eye = known::sphere(0.01, 8, 12);
  eye.V.col(2).array() += 0.08F;
  const Eigen::Index first = head.V.rows();
  mesh::append(head, eye);
  const auto skin =
      mesh::bind_skin(head, {bone("skull", {0, 0, 0}, {0, 0.02, 0}), bone("far", {0, -3, 0}, {0, -4, 0})});
  ASSERT_TRUE(skin);
  for (Eigen::Index v = first; v < skin->weight.rows(); ++v) {
    EXPECT_EQ(skin->index(v, 0), 0);
    EXPECT_NEAR(skin->weight(v, 0), 1, 1e-6);
  }
}

TEST(Bind, BadInputHasOneClearError) {
  const auto fault = [](const mesh::Surface& surface, const std::vector<mesh::Bone>& bones) {
    const auto skin = mesh::bind_skin(surface, bones);
    return skin ? "no error" : skin.error().kind + " " + skin.error().sentence;
  };
  EXPECT_EQ(fault(known::cube(), {}), "range a skin needs at least one bone; there is none");
  EXPECT_EQ(fault(mesh::Surface(), {bone("a", {0, 0, 0}, {0, 1, 0})}).substr(0, 5), "range");
  EXPECT_EQ(fault(known::cube(), {bone("thin", {0, 0, 0}, {0, 1, 0}, 0)}),
            "range bone thin needs finite positions and a radius above 0");
  mesh::Bone lost = bone("lost", {0, 0, 0}, {0, 1, 0});
  lost.twist_from = 3;
  EXPECT_EQ(fault(known::cube(), {lost}), "range bone lost takes its twist from a bone that does not exist");
}

TEST(Deform, BindPoseGivesTheSurfaceBack) {
  const mesh::Skin skin = arm();
  for (mesh::Blend blend : {mesh::Blend::dual_quaternion, mesh::Blend::linear}) {
    Eigen::MatrixX3f V, N;
    mesh::deform(skin, {skin.bones[0].bind, skin.bones[1].bind}, V, N, blend);
    EXPECT_LT((V - skin.surface.V).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((N - skin.surface.N).cwiseAbs().maxCoeff(), 1e-4);
  }
}

TEST(Deform, RigidMotionOfAllBonesMovesTheSurfaceRigidly) {
  const mesh::Skin skin = arm();
  const Isometry3d X = Translation3d(3, -1, 2) * AngleAxisd(2.4, Vector3d(1, 2, -1).normalized());
  for (mesh::Blend blend : {mesh::Blend::dual_quaternion, mesh::Blend::linear}) {
    Eigen::MatrixX3f V, N;
    mesh::deform(skin, {X, X}, V, N, blend);
    for (Eigen::Index v = 0; v < V.rows(); ++v) {
      const Vector3d expected = X * skin.surface.V.row(v).transpose().cast<double>();
      // single precision at a distance of 4 m
      EXPECT_LT((V.row(v).transpose().cast<double>() - expected).norm(), 2e-6);
    }
  }
}

TEST(Deform, ABentElbowKeepsItsVolume) {
  const mesh::Skin skin = arm();
  const std::vector<Isometry3d> bent = {Isometry3d::Identity(), turned_at({0, 0.5, 0}, 2.0, Vector3d::UnitX())};
  const double rest = volume(skin.surface, skin.surface.V);
  Eigen::MatrixX3f V, N;
  mesh::deform(skin, bent, V, N);
  // a real elbow bulges and folds; 5 % of the arm is the volume of 5 cm of it
  EXPECT_NEAR(volume(skin.surface, V) / rest, 1, 0.05);
}

TEST(Deform, ATwistedForearmDoesNotCollapse) {
  const mesh::Skin skin = arm();
  const std::vector<Isometry3d> twisted = {Isometry3d::Identity(), turned_at({0, 0.5, 0}, 2.6, Vector3d::UnitY())};
  Eigen::MatrixX3f V, N;
  mesh::deform(skin, twisted, V, N);
  // turned about its own axis every vertex keeps its distance from it; linear blending makes a candy wrapper
  const double smooth = narrowest(skin, V, 0.1, 0.9, Vector3d::Zero(), Vector3d::UnitY());
  mesh::deform(skin, twisted, V, N, mesh::Blend::linear);
  const double linear = narrowest(skin, V, 0.1, 0.9, Vector3d::Zero(), Vector3d::UnitY());
  EXPECT_NEAR(smooth, 0.1, 1e-4);
  EXPECT_LT(linear, 0.05);
}

TEST(Deform, TwistBonesShareATurnAndLeaveTheBendAlone) {
  std::vector<mesh::Bone> bones = {bone("base", {0, 0, 0}, {0, 0.3, 0}), bone("half", {0, 0.3, 0}, {0, 0.65, 0}),
                                   bone("end", {0, 0.65, 0}, {0, 1, 0})};
  bones[1].twist_from = 0;
  bones[1].twist = 0.5;
  const mesh::Skin skin = *mesh::bind_skin(known::tube(1, 0.1, 60, 32), bones);
  // the outer bones swing by 0.7 about z and turn by 1.2 about the axis
  const Isometry3d swing = turned_at({0, 0.3, 0}, 0.7, Vector3d::UnitZ());
  const Isometry3d X = swing * turned_at({0, 0.3, 0}, 1.2, Vector3d::UnitY());
  Eigen::MatrixX3f V, N;
  mesh::deform(skin, {Isometry3d::Identity(), X, X}, V, N);
  // a vertex in the middle of the half bone: swung, and turned by half
  const Isometry3d half = swing * turned_at({0, 0.3, 0}, 0.6, Vector3d::UnitY());
  int seen = 0;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    if (skin.index(v, 0) == 1 && skin.weight(v, 0) > 0.99999F) {
      ++seen;
      const Vector3d expected = half * skin.surface.V.row(v).transpose().cast<double>();
      EXPECT_LT((V.row(v).transpose().cast<double>() - expected).norm(), 1e-5);
    }
  }
  EXPECT_GT(seen, 0);
}

TEST(StandIn, IsClosedFollowsItsBonesAndHasAFace) {
  const std::vector<mesh::Bone> bones = {bone("arm", {0, 0, 0}, {0, -0.3, 0}, 0.05),
                                         bone("head", {0, 0.5, 0}, {0, 0.55, 0}, 0.08)};
  const mesh::Skin skin = mesh::stand_in(bones);
  const mesh::Topology t = mesh::topology(skin.surface);
  EXPECT_EQ(t.components, 2);
  EXPECT_TRUE(t.closed());
  EXPECT_TRUE(t.manifold());
  EXPECT_GT(t.volume, 0);
  // the nose is what is foremost, in the middle plane, at about the height of the middle of the head
  Eigen::Index nose = 0;
  skin.surface.V.col(2).maxCoeff(&nose);
  EXPECT_LT(std::abs(skin.surface.V(nose, 0)), 0.01);
  Eigen::MatrixX3f V, N;
  const Isometry3d lifted(Translation3d(0, 1, 0));
  mesh::deform(skin, {Isometry3d::Identity(), lifted}, V, N);
  EXPECT_NEAR(V(nose, 1), skin.surface.V(nose, 1) + 1, 1e-6);
  EXPECT_EQ(V(0, 1), skin.surface.V(0, 1));
}

}  // namespace
