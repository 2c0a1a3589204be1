#include "manipulators/face_fem/basis.h"

#include <gtest/gtest.h>

#include "manipulators/face_fem/muscle.h"
#include "manipulators/face_fem/skin_carrier.h"
#include "tests/manipulators/face_fem/bodies.h"

namespace face {
namespace {

using bodies::Vec3;

/// muscles strewn over the cap
std::vector<Field> muscle_loads(const Model& model, int count) {
  const ElementBoxes boxes(model);
  std::vector<Field> loads;
  for (int k = 0; k < count; ++k) {
    const double left = 0.9 * std::sin(2.1 * k), up = 0.9 * std::sin(1.3 * k + 1);
    const auto at = [](double x, double y, double r) {
      return Vec3(r * std::sin(x) * std::cos(y), r * std::sin(y), r * std::cos(x) * std::cos(y));
    };
    Muscle muscle{"m" + std::to_string(k), {{at(left, up, .066), at(left * .8, up * .8, .075), 0, .006, .1 + .01 * k}}};
    auto load = load_of(model, boxes, muscle);
    EXPECT_TRUE(load) << load.error().sentence;
    loads.push_back(load->load);
  }
  return loads;
}

struct Fixture {
  Statics statics;
  std::vector<Field> loads;
  Basis basis;
  explicit Fixture(Element element, int muscles)
      : statics(std::move(*Statics::make(cap(element, 6, 6, 3)))),
        loads(muscle_loads(statics.model(), muscles)),
        basis(statics, skin_nodes(statics.model())) {
    basis.add(loads);
  }
};

TEST(Basis, AFrameIsTheSolveOfTheWeightedLoads) {
  Fixture f(Element::bbar, 7);
  const std::vector<double> amounts = {0.3, 0, 1, 0.7, -0.2, 0, 0.5};
  Field sum = Field::Zero(3, f.loads[0].cols());
  for (int k = 0; k < 7; ++k) sum += amounts[k] * f.loads[k];
  const Field exact = f.statics.solve(sum).u, field = f.basis.field(amounts.data());
  EXPECT_LE((field - exact).norm(), 1e-13 * exact.norm());
  const std::vector<int> nodes = f.basis.nodes();
  std::vector<float> frame(3 * nodes.size());
  f.basis.frame(amounts.data(), frame.data());
  // single precision of the kept columns
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(frame[3 * k + i], exact(i, nodes[k]), 1e-6 * exact.cwiseAbs().maxCoeff());
}

TEST(Basis, ADraggedMuscleIsReplacedBySolvingIt) {
  Fixture f(Element::bbar, 3);
  const Field other = 2 * f.loads[2];
  f.basis.replace(1, other);
  const double amounts[3] = {0, 1, 0};
  const Field exact = f.statics.solve(other).u;
  EXPECT_LE((f.basis.field(amounts) - exact).norm(), 1e-13 * exact.norm());
}

TEST(Basis, MovesABoneByASuperposedColumn) {
  Fixture f(Element::bbar, 1);
  Field shift = Field::Zero(3, f.loads[0].cols());
  for (const Support& s : f.statics.model().supports) shift.col(s.node) = Vec3(0, 1e-3, 0);
  const int column = f.basis.add_shift(shift);
  EXPECT_EQ(column, 1);
  // all bone moves alike, so all tissue does
  EXPECT_NEAR((f.basis.column(column).colwise() - Vec3(0, 1e-3, 0)).norm(), 0, 1e-14);
}

/// points on the sides of the skin, and what a linear field does there
template <class Check>
void for_points_on_skin(const Model& model, Check&& check) {
  const int corners = nodes_of(model.element) == 20 ? 8 : 4;
  Eigen::Matrix3Xd points(3, Eigen::Index(model.skin.size()));
  for (std::size_t k = 0; k < model.skin.size(); ++k) {
    points.col(Eigen::Index(k)).setZero();
    for (int a = 0; a < corners; ++a) {
      const double weight = corners == 4 ? 0.25 : a < 4 ? -0.25 : 0.5;
      points.col(Eigen::Index(k)) +=
          weight * model.nodes[model.hexahedra[model.skin[k].hexahedron].node[side_nodes[model.skin[k].side][a]]];
    }
  }
  check(points);
}

class CarriedSkin : public testing::TestWithParam<Element> {};

TEST_P(CarriedSkin, FollowsALinearFieldExactly) {
  const Model model = cap(GetParam(), 6, 5, 3);
  for_points_on_skin(model, [&](const Eigen::Matrix3Xd& points) {
    auto carrier = SkinCarrier::bind(model, points);
    ASSERT_TRUE(carrier);
    EXPECT_EQ(carrier->vertices(), int(points.cols()));
    EXPECT_LE(carrier->farthest(), 1e-9);
    Eigen::Matrix3d G;
    G << 1, 2, 3, -1, 0.5, 2, 0.3, 0.1, -2;
    const std::vector<int> nodes = skin_nodes(model);
    std::vector<float> moved(3 * nodes.size()), out(3 * std::size_t(points.cols()));
    for (std::size_t k = 0; k < nodes.size(); ++k)
      Eigen::Map<Eigen::Vector3f>(moved.data() + 3 * k) = (G * model.nodes[nodes[k]]).cast<float>();
    carrier->carry(moved.data(), out.data());
    for (int v = 0; v < points.cols(); ++v)
      EXPECT_LE((Eigen::Map<Eigen::Vector3f>(out.data() + 3 * v) - (G * points.col(v)).cast<float>()).norm(), 1e-6);
  });
}

TEST_P(CarriedSkin, BindsVerticesOffTheSkinToTheNearestPoint) {
  const Model model = cap(GetParam(), 6, 5, 3);
  for_points_on_skin(model, [&](Eigen::Matrix3Xd points) {
    // outward along the radius by 2 mm; the sides are chords, so their distance is a little off
    for (int v = 0; v < points.cols(); ++v) points.col(v) *= 1 + 0.002 / points.col(v).norm();
    auto carrier = SkinCarrier::bind(model, points);
    ASSERT_TRUE(carrier);
    for (float distance : carrier->distance()) EXPECT_NEAR(distance, 0.002, 0.0001);
  });
}

INSTANTIATE_TEST_SUITE_P(Elements, CarriedSkin, testing::Values(Element::bbar, Element::hex20),
                         [](const auto& chosen) { return std::string(name_of(chosen.param)); });

TEST(CarriedSkinErrors, AModelWithoutSkinCarriesNothing) {
  Model model = cap(Element::bbar, 3, 3, 3);
  model.skin.clear();
  const auto carrier = SkinCarrier::bind(model, Eigen::Matrix3Xd::Zero(3, 1));
  ASSERT_FALSE(carrier);
  EXPECT_EQ(carrier.error().fault, Fault::mesh);
}

}  // namespace
}  // namespace face
