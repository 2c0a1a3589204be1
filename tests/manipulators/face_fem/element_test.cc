#include "manipulators/face_fem/element.h"

#include <gtest/gtest.h>

#include <random>

#include "manipulators/face_fem/shape.h"
#include "manipulators/face_fem/stress.h"
#include "tests/manipulators/face_fem/bodies.h"

namespace face {
namespace {

using bodies::Vec3;

/// a brick whose corners are pushed about, its mid-edge nodes in the middle
Corners crooked(Element element) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> push(-0.15, 0.15);
  Model model = grid(element, 1, 1, 1, [](const Vec3& p) { return p; });
  Corners X = corners_of(model, 0);
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) X(i, a) += push(random);
  static constexpr int ends[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                      {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  for (int a = 8; a < X.cols(); ++a) X.col(a) = (X.col(ends[a - 8][0]) + X.col(ends[a - 8][1])) / 2;
  return X;
}

class EveryElement : public testing::TestWithParam<Element> {};

TEST_P(EveryElement, HasShapeFunctionsThatSumToOneAndAreOneAtTheirNode) {
  const int n = nodes_of(GetParam());
  for (int b = 0; b < n; ++b) {
    double N[20];
    shape(n, reference_nodes()[b], N);
    for (int a = 0; a < n; ++a) EXPECT_NEAR(N[a], a == b, 1e-15);
  }
  double N[20], dN[20][3], sum = 0, slope[3] = {0, 0, 0};
  const Vec3 xi(0.3, -0.7, 0.2);
  shape(n, xi, N);
  shape_gradient(n, xi, dN);
  for (int a = 0; a < n; ++a) {
    sum += N[a];
    for (int i = 0; i < 3; ++i) slope[i] += dN[a][i];
  }
  EXPECT_NEAR(sum, 1, 1e-15);
  for (double s : slope) EXPECT_NEAR(s, 0, 1e-15);
}

TEST_P(EveryElement, HasGradientsThatAgreeWithDifferences) {
  const int n = nodes_of(GetParam());
  const Vec3 xi(0.3, -0.7, 0.2);
  double dN[20][3];
  shape_gradient(n, xi, dN);
  constexpr double step = 1e-6;
  for (int i = 0; i < 3; ++i) {
    double up[20], down[20];
    shape(n, xi + step * Vec3::Unit(i), up);
    shape(n, xi - step * Vec3::Unit(i), down);
    // central differences of a cubic: error step^2, rounding 1e-16 / step
    for (int a = 0; a < n; ++a) EXPECT_NEAR(dN[a][i], (up[a] - down[a]) / (2 * step), 1e-9);
  }
}

TEST_P(EveryElement, DoesNotResistRigidMotionAndNothingElse) {
  const Corners X = crooked(GetParam());
  const int n = int(X.cols());
  const Eigen::MatrixXd K = stiffness_of(GetParam(), X, {1.5, 1});
  EXPECT_LE((K - K.transpose()).norm(), 1e-14 * K.norm());
  Eigen::MatrixXd rigid(3 * n, 6);
  for (int a = 0; a < n; ++a)
    for (int i = 0; i < 3; ++i) {
      rigid.block<3, 1>(3 * a, i) = Vec3::Unit(i);
      rigid.block<3, 1>(3 * a, 3 + i) = Vec3::Unit(i).cross(Vec3(X.col(a)));
    }
  EXPECT_LE((K * rigid).norm(), 1e-13 * K.norm());
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  const double largest = eigenvalues[3 * n - 1];
  int zero = 0;
  for (double value : eigenvalues) {
    EXPECT_GE(value, -1e-13 * largest);
    zero += value < 1e-10 * largest;
  }
  // eight points with six strains give rank 48 of 60: hex20r alone has six spare modes
  EXPECT_EQ(zero, GetParam() == Element::hex20r ? 12 : 6);
}

TEST_P(EveryElement, PassesThePatchTestOfMacNealAndHarder) {
  Model model = bodies::patch_cube(GetParam());
  model.materials = {{"patch", 1e6, 0.25, 0}};
  // their displacement, plus a rotation so that all nine gradients differ
  Eigen::Matrix3d G;
  G << 2, 1, 1, 1, 2, 1, 1, 1, 2;
  G *= 0.5e-3;
  G(0, 1) += 3e-4;
  G(2, 1) -= 2e-4;
  for (int n = 0; n < int(model.nodes.size()); ++n) {
    const Vec3& p = model.nodes[n];
    if ((p.array() < 1e-9 || p.array() > 1 - 1e-9).any()) bodies::hold(model, n, {true, true, true}, G * p);
  }
  auto statics = Statics::make(model);
  ASSERT_TRUE(statics) << statics.error().sentence;
  const Field u = statics->solve(Field::Zero(3, int(model.nodes.size()))).u;
  const Eigen::Matrix3d strain = (G + G.transpose()) / 2;
  const Lame lame = model.materials[0].lame();
  const Eigen::Matrix3d s = 2 * lame.mu * strain + lame.lambda * strain.trace() * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 6, 1> exact;
  exact << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0);
  const auto stress = stress_field(model, u);
  // the exact answer lies in the space of the element: only rounding is left
  for (int n = 0; n < u.cols(); ++n) {
    EXPECT_LE((u.col(n) - G * model.nodes[n]).norm(), 1e-13 * G.norm());
    EXPECT_LE((stress.col(n) - exact).norm(), 1e-12 * exact.norm());
  }
}

TEST_P(EveryElement, GivesTheSameStiffnessHoweverTheBrickIsTurned) {
  const Corners X = crooked(GetParam());
  const int n = int(X.cols());
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Corners turned = R * X;
  const Eigen::MatrixXd K = stiffness_of(GetParam(), X, {1.5, 1}), L = stiffness_of(GetParam(), turned, {1.5, 1});
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      EXPECT_LE((L.block<3, 3>(3 * a, 3 * b) - R * K.block<3, 3>(3 * a, 3 * b) * R.transpose()).norm(),
                1e-13 * K.norm());
}

INSTANTIATE_TEST_SUITE_P(All, EveryElement, testing::ValuesIn(all_elements),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST(Element, NamesReadBack) {
  for (Element element : all_elements) EXPECT_EQ(element_named(name_of(element)), element);
  EXPECT_FALSE(element_named("hex9"));
}

TEST(Element, HexTwentyPointRuleIntegratesTheVolumeOfACurvedBrick) {
  // a 90 degree sector of a ring has volume pi/4 (b^2 - a^2) h; the quadratic arc misses it by its sagitta only
  const Model ring = bodies::curved_beam(Element::hex20, 6, 1, 1, Vec3::Zero()).model;
  double volume = 0;
  for (int e = 0; e < 6; ++e) {
    const Corners X = corners_of(ring, e);
    const Rule& rule = gauss_rule(20, 3);
    for (int q = 0; q < rule.points; ++q) volume += rule.weight[q] * jacobian(X, rule.xi[q]).determinant();
  }
  // a quadratic through 15 degrees of arc misses its area by about angle^4 / 2900
  EXPECT_NEAR(volume / (bodies::pi / 4 * (4.32 * 4.32 - 4.12 * 4.12) * 0.1), 1, 1e-4);
}

}  // namespace
}  // namespace face
