#include "manipulators/eye_control/methods.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/manipulators/eye_control/report.h"

namespace eye::test {
namespace {

TEST(MethodTable, HasTheErrorsThatAreMeasured) {
  for (const MethodRow& row : method_table()) {
    const double error = measured_error(row.method);
    report("method", "%s: %.3f deg from the whole model, %.0f ns a figure and step",
           std::string(word(row.method)).c_str(), error / deg, 1e9 * row.cost);
    EXPECT_NEAR(row.error, error, 0.001 * deg) << word(row.method);
  }
}

TEST(MethodTable, GoesFromCheapToComplete) {
  for (size_t k = 1; k < method_table().size(); ++k) {
    EXPECT_GT(method_table()[k].cost, method_table()[k - 1].cost);
    EXPECT_LT(method_table()[k].error, method_table()[k - 1].error);
  }
}

TEST(MethodTable, AnswersBudgets) {
  for (const MethodRow& row : method_table()) {
    // exactly its error buys it, a little less the next
    EXPECT_EQ(within_error(row.error), row.method);
    EXPECT_EQ(within_time(100 * tick_cost(row.method, 16), 100, 16), row.method);
    EXPECT_LE(row_of(within_error(0.99 * row.error)).error, 0.99 * row.error);
  }
  EXPECT_EQ(within_error(10), Method::snap);
  EXPECT_EQ(within_time(1, 100, 16), Method::full);
  EXPECT_EQ(within_time(0, 100, 16), Method::snap);
}

}  // namespace
}  // namespace eye::test
