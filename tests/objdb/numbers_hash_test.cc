#include <set>

#include <gtest/gtest.h>

#include "objdb/numbers.h"

namespace objdb {
namespace {

TEST(HashNumbers, KnowsEveryBitEveryPlaceAndTheLength) {
  std::set<std::uint64_t> seen;
  std::size_t count = 0;
  for (std::size_t length = 0; length <= 17; ++length) {
    std::vector<double> numbers(length);
    seen.insert(hash_numbers(numbers));
    ++count;
    for (std::size_t i = 0; i < length; ++i)
      for (const double value : {-0.0, 1.0, 1.0000000000000002}) {
        numbers[i] = value;
        seen.insert(hash_numbers(numbers));
        ++count;
        numbers[i] = 0;
      }
  }
  EXPECT_EQ(seen.size(), count);
}

TEST(HashNumbers, IsTheSameEverywhere) {
  // journals are read on other machines; the number comes from the same sum in Python
  EXPECT_EQ(hash_numbers(std::vector<double>{1, 2, 3, 4, 5}), 2081040451574290678u);
}

}  // namespace
}  // namespace objdb
