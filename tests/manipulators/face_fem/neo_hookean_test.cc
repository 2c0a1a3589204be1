#include "manipulators/face_fem/neo_hookean.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "manipulators/face_fem/muscle.h"
#include "manipulators/face_fem/validity.h"
#include "tests/manipulators/face_fem/bodies.h"

namespace face {
namespace {

using bodies::pi;
using bodies::Vec3;

Model crooked_cube(Element element) {
  Model model = bodies::make_case(bodies::patch_cube(element), 1, .4).model;
  for (int n = 8; n < 11; ++n) bodies::hold(model, n, {true, true, true});
  return model;
}

Field noise(const Model& model, double size, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> value(0, size);
  Field u(3, int(model.nodes.size()));
  for (int k = 0; k < u.size(); ++k) u.data()[k] = value(random);
  return u;
}

class NeoHookean : public testing::TestWithParam<Element> {};

TEST_P(NeoHookean, HasForcesAndHessianThatAgreeWithDifferences) {
  const Model model = crooked_cube(GetParam());
  const Field u = noise(model, .03, 3), direction = noise(model, .03, 4);
  const auto here = energy_state(model, u, false);
  ASSERT_TRUE(here) << here.error().sentence;
  constexpr double step = 1e-5;
  const auto ahead = energy_state(model, u + step * direction, false);
  const auto behind = energy_state(model, u - step * direction, false);
  const double slope = here->force.cwiseProduct(direction).sum();
  // central differences: truncation step^2, rounding 1e-16 / step
  EXPECT_NEAR((ahead->energy - behind->energy) / (2 * step), slope, 1e-7 * std::abs(slope));
  const Field curved = multiply(here->hessian, direction);
  EXPECT_LE(((ahead->force - behind->force) / (2 * step) - curved).norm(), 1e-7 * curved.norm());
}

TEST_P(NeoHookean, IsTheLinearModelAtRest) {
  const Model model = crooked_cube(GetParam());
  const auto rest = energy_state(model, Field::Zero(3, int(model.nodes.size())), false);
  ASSERT_TRUE(rest);
  EXPECT_NEAR(rest->energy, 0, 1e-14);
  EXPECT_LE(rest->force.norm(), 1e-14);
  const auto linear = assemble(model);
  for (std::size_t k = 0; k < linear->block.size(); ++k) EXPECT_NEAR(rest->hessian.block[k], linear->block[k], 1e-13);
}

TEST_P(NeoHookean, DoesNotFeelRotation) {
  const Model model = crooked_cube(GetParam());
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  Field turned(3, int(model.nodes.size()));
  for (int n = 0; n < turned.cols(); ++n) turned.col(n) = R * model.nodes[n] - model.nodes[n];
  const auto state = energy_state(model, turned, false);
  EXPECT_NEAR(state->energy, 0, 1e-14);
  EXPECT_LE(state->force.norm(), 1e-13);
}

TEST_P(NeoHookean, TheProjectedHessianHasNoNegativeCurvature) {
  const Model model = crooked_cube(GetParam());
  const Field u = noise(model, .15, 5);
  const auto plain = energy_state(model, u, false), projected = energy_state(model, u, true);
  for (int seed = 0; seed < 20; ++seed) {
    const Field d = noise(model, 1, 100 + seed);
    const double curvature = d.cwiseProduct(multiply(projected->hessian, d)).sum();
    EXPECT_GE(curvature, -1e-12 * d.squaredNorm());
    EXPECT_GE(curvature, d.cwiseProduct(multiply(plain->hessian, d)).sum() - 1e-10 * d.squaredNorm());
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, NeoHookean, testing::Values(Element::hex8, Element::bbar, Element::hex20),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

/// a cap pulled by one muscle so hard that the linear model moves `peak` metres
struct Pulled {
  Model model;
  Field load, linear;
};

Pulled pulled(double peak) {
  Pulled p{cap(Element::bbar, 8, 8, 3), {}, {}};
  const Muscle muscle{"pull", {{Vec3(.02, 0, .07), Vec3(-.02, 0, .07), 0, .008, 1}}};
  auto load = load_of(p.model, ElementBoxes(p.model), muscle);
  auto statics = Statics::make(p.model);
  p.linear = statics->solve(load->load).u;
  const double scale = peak / p.linear.colwise().norm().maxCoeff();
  p.load = scale * load->load;
  p.linear *= scale;
  return p;
}

TEST(NeoHookeanSolve, GivesTheLinearAnswerForSmallLoads) {
  const Pulled p = pulled(1e-6);
  const auto solution = solve_neo_hookean(p.model, p.load, Field::Zero(3, p.load.cols()));
  ASSERT_TRUE(solution) << solution.error().sentence;
  EXPECT_EQ(solution->status, Convergence::converged);
  // the difference is of second order: strain 1e-4 times a few
  EXPECT_LE((solution->u - p.linear).norm(), 1e-3 * solution->u.norm());
}

TEST(NeoHookeanSolve, DepartsFromTheLinearAnswerInProportionToTheLoad) {
  double last = 0;
  for (double peak : {2e-3, 4e-3, 8e-3}) {
    const Pulled p = pulled(peak);
    const auto solution = solve_neo_hookean(p.model, p.load, Field::Zero(3, p.load.cols()));
    ASSERT_TRUE(solution);
    EXPECT_EQ(solution->status, Convergence::converged);
    EXPECT_LE(solution->residual, 1e-8);
    const double apart = (solution->u - p.linear).norm() / solution->u.norm();
    if (last > 0) {
      EXPECT_NEAR(apart / last, 2, 0.3);
    }
    last = apart;
  }
  // 8 mm, a strong expression: under a tenth
  EXPECT_LE(last, 0.1);
}

TEST(NeoHookeanSolve, KeepsTheVolumeOfACantileverThatTheLinearModelInflates) {
  Model model =
      bodies::make_case(grid(Element::hex8, 10, 2, 2, [](const Vec3& p) { return Vec3(10 * p.x(), p.y(), p.z()); }),
                        1e4, 0.45)
          .model;
  bodies::hold_where(model, [](const Vec3& p) { return p.x() < 1e-9; }, {true, true, true});
  Field load = Field::Zero(3, int(model.nodes.size()));
  bodies::add_traction(model, grid_sides(10, 2, 2, 0, true), Vec3(0, 0, 20), load);
  const Field linear = Statics::make(model)->solve(load).u;
  const auto solution = solve_neo_hookean(model, load, Field::Zero(3, load.cols()));
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->status, Convergence::converged);
  EXPECT_GT(validity_of(model, linear).volume, 0.02);
  EXPECT_LE(std::abs(validity_of(model, solution->u).volume), 0.01);
  // the reaction carries the load, and the end does not grow out of its length
  EXPECT_LE((solution->reaction.rowwise().sum() + Vec3(0, 0, 20)).norm(), 1e-6);
  const Vec3 tip = bodies::mean_near(model, solution->u, [](const Vec3& p) { return p.x() > 10 - 1e-9; });
  EXPECT_LT(tip.x(), 0);
}

TEST(NeoHookeanSolve, RefusesIncompatibleModes) {
  Model model = cap(Element::wt, 3, 3, 3);
  const Field none = Field::Zero(3, int(model.nodes.size()));
  const auto solution = solve_neo_hookean(model, none, none);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().fault, Fault::element);
}

TEST(Validity, TellsInvertedElementsStrainAndTurnedBones) {
  const Pulled p = pulled(1e-4);
  EXPECT_TRUE(validity_of(p.model, p.linear).linear());
  const Validity strained = validity_of(p.model, 90 * p.linear);
  EXPECT_STREQ(strained.word(), "strain");
  EXPECT_FALSE(warnings_of(p.model, strained).empty());
  const Validity inverted = validity_of(p.model, 400 * p.linear);
  EXPECT_GT(inverted.inverted, 0);
  EXPECT_STREQ(inverted.word(), "inverted");
  // a rigid turn of three degrees: nothing is strained much, but the linear model does not hold
  const Eigen::Matrix3d R = Eigen::AngleAxisd(3 * pi / 180, Vec3(1, 2, 0).normalized()).toRotationMatrix();
  Field turned(3, p.linear.cols());
  for (int n = 0; n < turned.cols(); ++n) turned.col(n) = R * p.model.nodes[n] - p.model.nodes[n];
  const Validity bone = validity_of(p.model, turned);
  EXPECT_NEAR(bone.bone_turn, 3 * pi / 180, 1e-9);
  EXPECT_STREQ(bone.word(), "bone_turn");
  EXPECT_NEAR(bone.volume, 0, 1e-12);
}

/// a published face mesh (8720 nodes, 6024 bricks and 318 wedges), millimetres; empty when it is not there
Model published_face() {
  const char* variable = std::getenv("SAILOR_DATA");
  const std::string folder =
      (variable != nullptr ? std::string(variable) : SOURCE_DIR "/../shared/data") + "/face_mesh/";
  Model model;
  model.element = Element::hex8;
  const auto rows = [&](const char* name, auto&& take) {
    std::ifstream file(folder + name);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      take(words);
    }
  };
  rows("newface.node", [&](std::istream& words) {
    int label;
    Vec3 p;
    if (words >> label >> p.x() >> p.y() >> p.z()) model.nodes.push_back(p / 1000);
  });
  rows("newface.elem", [&](std::istream& words) {
    Hexahedron h;
    for (int a = 0; a < 8; ++a)
      if (words >> h.node[a]) --h.node[a];
    if (words) model.hexahedra.push_back(h);
  });
  for (int bone = 0; bone < 2; ++bone)
    rows(bone == 0 ? "fixed_skull_nose.node" : "fixed_mandible.node", [&](std::istream& words) {
      Support support;
      support.bone = bone;
      if (words >> support.node) {
        --support.node;
        model.supports.push_back(support);
      }
    });
  model.bones = {"skull", "mandible"};
  model.materials = {{"tissue", 15e3, .45, 1040}};
  return model;
}

/// opens the jaw about an axis through the joints (assumed 10 mm behind and 25 mm below the mesh's origin)
Field opened(const Model& model, double degrees) {
  Field shift = Field::Zero(3, int(model.nodes.size()));
  const Vec3 hinge(0, -.010, -.025);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-degrees * pi / 180, Vec3::UnitX()).toRotationMatrix();
  for (const Support& s : model.supports)
    if (s.bone == 1) shift.col(s.node) = R * (model.nodes[s.node] - hinge) + hinge - model.nodes[s.node];
  return shift;
}

TEST(SlowJaw, OpensTwentyDegreesOnThePublishedFaceWhereTheLinearModelWarnsFromTwo) {
  const Model model = published_face();
  if (model.nodes.empty()) GTEST_SKIP() << "the face mesh of the reference data is not here (SAILOR_DATA)";
  auto statics = Statics::make(model);
  ASSERT_TRUE(statics) << statics.error().sentence;
  const Field none = Field::Zero(3, int(model.nodes.size()));
  const Field small = statics->solve(none, opened(model, 1.9)).u, large = statics->solve(none, opened(model, 5)).u;
  EXPECT_EQ(validity_of(model, small).inverted, 0);
  EXPECT_NEAR(validity_of(model, small).bone_turn, 1.9 * pi / 180, 1e-9);
  EXPECT_GT(validity_of(model, large).inverted, 0);
  EXPECT_STREQ(validity_of(model, large).word(), "inverted");
  const auto wide = solve_neo_hookean(model, none, opened(model, 20));
  ASSERT_TRUE(wide) << wide.error().sentence;
  EXPECT_EQ(wide->status, Convergence::converged);
  EXPECT_EQ(wide->reached, 1);
  EXPECT_LE(wide->residual, 1e-8);
}

}  // namespace
}  // namespace face
