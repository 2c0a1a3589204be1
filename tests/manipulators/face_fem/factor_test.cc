#include "manipulators/face_fem/factor.h"

#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "tests/manipulators/face_fem/bodies.h"

namespace face {
namespace {

Field some_load(const Model& model) {
  Field f(3, int(model.nodes.size()));
  for (int k = 0; k < f.size(); ++k) f.data()[k] = 1e-3 * std::sin(0.7 * k);
  return f;
}

Field held_zero(const Statics& statics, Field f) {
  for (int n = 0; n < f.cols(); ++n)
    for (int i = 0; i < 3; ++i)
      if (statics.held()[n][i]) f(i, n) = 0;
  return f;
}

/// the same system by another library, with another order
Field by_eigen(const Statics& statics, const Field& load) {
  const Stiffness& K = statics.stiffness();
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < K.nodes; ++c)
    for (int k = K.start[c]; k < K.start[c + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int row = 3 * K.row[k] + i, column = 3 * c + j;
          if (row < column || statics.held()[K.row[k]][i] || statics.held()[c][j]) continue;
          entries.emplace_back(row, column, K.block[9 * std::size_t(k) + 3 * i + j]);
        }
  for (int n = 0; n < K.nodes; ++n)
    for (int i = 0; i < 3; ++i)
      if (statics.held()[n][i]) entries.emplace_back(3 * n + i, 3 * n + i, 1.0);
  Eigen::SparseMatrix<double> A(3 * K.nodes, 3 * K.nodes);
  A.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(A);
  const Field f = held_zero(statics, load);
  const Eigen::VectorXd x = solver.solve(Eigen::Map<const Eigen::VectorXd>(f.data(), f.size()));
  return Eigen::Map<const Field>(x.data(), 3, K.nodes);
}

class BothEliminations : public testing::TestWithParam<Elimination> {};

TEST_P(BothEliminations, AgreeWithAnIndependentFactorisation) {
  for (Order order : {Order::metis, Order::amd}) {
    auto statics = Statics::make(cap(Element::bbar, 6, 7, 3), {order, GetParam()});
    ASSERT_TRUE(statics) << statics.error().sentence;
    const Field load = some_load(statics->model());
    const Solution solution = statics->solve(load);
    const Field other = by_eigen(*statics, load);
    // condition 3e3 times rounding
    EXPECT_LE((solution.u - other).norm(), 1e-12 * other.norm());
    EXPECT_LE(solution.residual, 1e-12);
  }
}

TEST_P(BothEliminations, HandleSupportsOfSingleAxes) {
  const bodies::Case plate = bodies::le10(Element::hex20, 2, 3, 2);
  auto statics = Statics::make(plate.model, {Order::metis, GetParam()});
  ASSERT_TRUE(statics) << statics.error().sentence;
  const Field u = statics->solve(plate.load).u, other = by_eigen(*statics, plate.load);
  EXPECT_LE((u - other).norm(), 1e-11 * other.norm());
}

INSTANTIATE_TEST_SUITE_P(Factor, BothEliminations, testing::Values(Elimination::fronts, Elimination::cholmod),
                         [](const auto& chosen) { return chosen.param == Elimination::fronts ? "fronts" : "cholmod"; });

TEST(Factor, SolvesManyLoadsAsItSolvesOne) {
  auto statics = Statics::make(cap(Element::bbar, 6, 6, 3));
  ASSERT_TRUE(statics);
  const Field load = some_load(statics->model());
  Eigen::MatrixXd columns(load.size(), 5);
  for (int c = 0; c < 5; ++c) columns.col(c) = (c + 1) * Eigen::Map<const Eigen::VectorXd>(load.data(), load.size());
  statics->factor().solve_all(columns);
  const Field one = statics->factor().solve(load);
  for (int c = 0; c < 5; ++c) {
    const Eigen::Map<const Field> many(columns.col(c).data(), 3, load.cols());
    EXPECT_LE((many - (c + 1) * one).norm(), 1e-13 * (c + 1) * one.norm());
  }
}

TEST(Factor, SolvesInSinglePrecisionToSevenDigits) {
  auto statics = Statics::make(cap(Element::bbar, 8, 8, 3));
  ASSERT_TRUE(statics);
  const Field load = some_load(statics->model());
  const Field exact = statics->factor().solve(load), single = statics->factor().solve_single(load);
  // unit rounding 6e-8 over some hundred operations a row
  EXPECT_LE((single - exact).norm(), 1e-6 * exact.norm());
  EXPECT_GT((single - exact).norm(), 0);
}

TEST(Factor, GivesTheSameBitsEveryTime) {
  Field first;
  for (int run = 0; run < 2; ++run) {
    auto statics = Statics::make(cap(Element::bbar, 6, 6, 3));
    ASSERT_TRUE(statics);
    const Field u = statics->solve(some_load(statics->model())).u;
    if (run == 0)
      first = u;
    else
      EXPECT_EQ(u, first);
  }
}

TEST(Factor, CountsTheEntriesThatItHas) {
  auto statics = Statics::make(cap(Element::bbar, 6, 6, 3));
  ASSERT_TRUE(statics);
  const Symbolic& s = statics->factor().symbolic();
  double lower = 0;
  for (int k = 0; k < s.supernodes(); ++k)
    for (int c = 0; c < 3 * s.columns(k); ++c) lower += 3 * s.rows(k) - c;
  EXPECT_EQ(statics->factor().cost().nonzeros, lower);
  EXPECT_EQ(s.free_nodes(), 7 * 7 * 3);
}

TEST(Statics, AnElementIsStiffenedInPlace) {
  for (Element element : {Element::bbar, Element::hex20}) {
    Model model = cap(element, 4, 4, 3);
    auto statics = Statics::make(model);
    ASSERT_TRUE(statics);
    const Field load = some_load(model);
    ASSERT_TRUE(statics->stiffen(17, 5));
    ASSERT_TRUE(statics->stiffen(2, 0.3));
    // the same with materials of their own, factored anew
    model.materials.push_back(model.materials[model.hexahedra[17].material]);
    model.materials.back().young *= 5;
    model.hexahedra[17].material = 3;
    model.materials.push_back(model.materials[model.hexahedra[2].material]);
    model.materials.back().young *= 0.3;
    model.hexahedra[2].material = 4;
    const Field expected = Statics::make(model)->solve(load).u;
    const Solution updated = statics->solve(load);
    EXPECT_LE((updated.u - expected).norm(), 1e-12 * expected.norm());
    EXPECT_LE(updated.residual, 1e-11);
  }
}

TEST(Statics, RefusesToStiffenByNothing) {
  auto statics = Statics::make(cap(Element::bbar, 3, 3, 3));
  ASSERT_TRUE(statics);
  EXPECT_EQ(statics->stiffen(0, 0).error().fault, Fault::material);
  EXPECT_EQ(statics->stiffen(0, NAN).error().fault, Fault::material);
  EXPECT_EQ(statics->stiffen(999, 2).error().fault, Fault::unknown);
}

TEST(Statics, AThousandEditsLeaveNoDrift) {
  auto statics = Statics::make(cap(Element::bbar, 4, 4, 3));
  ASSERT_TRUE(statics);
  const Field load = some_load(statics->model());
  const Field before = statics->solve(load).u;
  for (int edit = 0; edit < 500; ++edit) {
    const int element = (7 * edit) % 48;
    ASSERT_TRUE(statics->stiffen(element, 3));
    ASSERT_TRUE(statics->stiffen(element, 1.0 / 3));
  }
  EXPECT_LE((statics->factor().solve(load) - before).norm(), 1e-12 * before.norm());
}

TEST(Statics, MovesSupportsAndReportsTheirReactions) {
  Model model = cap(Element::bbar, 5, 5, 3);
  auto statics = Statics::make(model);
  ASSERT_TRUE(statics);
  // all supports turn together: the tissue follows rigidly (to first order) and nothing pulls
  Field shift = Field::Zero(3, int(model.nodes.size()));
  const Eigen::Vector3d turn(1e-3, 2e-3, -1e-3);
  for (const Support& s : model.supports) shift.col(s.node) = turn.cross(model.nodes[s.node]);
  const Solution moved = statics->solve(Field::Zero(3, shift.cols()), shift);
  for (int n = 0; n < shift.cols(); ++n) EXPECT_LE((moved.u.col(n) - turn.cross(model.nodes[n])).norm(), 1e-14);
  // with a load, the supports carry all of it
  const Field load = some_load(model);
  const Solution solution = statics->solve(load);
  Field free = held_zero(*statics, load);
  EXPECT_LE((solution.reaction + load).rowwise().sum().norm(), 1e-12 * load.norm());
}

}  // namespace
}  // namespace face
