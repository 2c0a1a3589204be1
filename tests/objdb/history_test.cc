#include "objdb/history.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

namespace objdb {
namespace {

TEST(History, HoldsWhatADequeHolds) {
  History<int> history;
  std::deque<int> plain;
  std::mt19937 random(1);
  // grows for a while, then shrinks at both ends, through several blocks and down to nothing
  for (int step = 0; step < 60'000; ++step) {
    const unsigned chance = random() % 10;
    const bool grows = (step / 10'000) % 2 == 0;
    if (chance < (grows ? 8u : 2u)) {
      history.push() = step;
      plain.push_back(step);
    } else if (!plain.empty() && chance % 2 == 0) {
      history.pop_back();
      plain.pop_back();
    } else if (!plain.empty()) {
      history.pop_front();
      plain.pop_front();
    }
    ASSERT_EQ(history.size(), plain.size());
    if (plain.empty()) continue;
    ASSERT_EQ(history.front(), plain.front());
    ASSERT_EQ(history.back(), plain.back());
  }
}

}  // namespace
}  // namespace objdb
