#include "objdb/numbers.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "objdb/value.h"

namespace objdb {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();

TEST(Numbers, AreSharedByTheirCopies) {
  const Numbers row{1, 2, 3};
  const Numbers copy = row;
  EXPECT_EQ(copy.data(), row.data());
  EXPECT_EQ(copy, row);
  EXPECT_EQ(copy.hash(), hash_numbers(row));
  std::vector<double> changed = copy.vector();
  changed[1] = 7;
  EXPECT_EQ(row[1], 2);
  EXPECT_FALSE(Numbers(changed) == row);
  EXPECT_TRUE(Numbers().empty());
  EXPECT_EQ(Numbers(), Numbers(std::vector<double>()));
}

TEST(Numbers, ThatWillNotLastAreCopied) {
  std::vector<double> memory{1, 2, 3};
  const Numbers seen(std::make_shared<NumberBlock>(memory, false));
  const Numbers kept = seen;
  Value value = kept;
  Numbers assigned;
  assigned = seen;
  EXPECT_EQ(seen.hash(), kept.hash());
  memory[0] = 9;
  EXPECT_EQ(seen[0], 9);
  EXPECT_EQ(kept[0], 1);
  EXPECT_EQ(assigned[0], 1);
  EXPECT_EQ(std::get<Numbers>(value)[0], 1);
  EXPECT_NE(seen.hash(), kept.hash());
  // moved, they still stand where they stood
  Numbers moved = Numbers(std::make_shared<NumberBlock>(memory, false));
  EXPECT_EQ(moved.data(), memory.data());
}

TEST(AllFinite, FindsEveryBadNumberInEveryPlace) {
  for (std::size_t length = 0; length <= 19; ++length) {
    std::vector<double> numbers(length, 1.5);
    EXPECT_TRUE(all_finite(numbers));
    for (std::size_t i = 0; i < length; ++i) {
      for (const double bad : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
        numbers[i] = bad;
        EXPECT_FALSE(all_finite(numbers)) << bad << " at " << i << " of " << length;
      }
      numbers[i] = 1.5;
    }
  }
  // two that cancel
  EXPECT_FALSE(all_finite(std::vector<double>{infinity, -infinity}));
}

TEST(AllFinite, IsNotDeceivedByASumThatOverflows) {
  EXPECT_TRUE(all_finite(std::vector<double>(40, most)));
  EXPECT_TRUE(all_finite(std::vector<double>{most, -most, most, -most, 5e-324, -0.0}));
  std::vector<double> numbers(40, most);
  numbers[33] = std::nan("");
  EXPECT_FALSE(all_finite(numbers));
}

}  // namespace
}  // namespace objdb
