#include "dialog_manager/restart_policy.h"

#include <gtest/gtest.h>

#include "dialog_manager/answer.h"
#include "dialog_manager/own_rate.h"
#include "dialog_manager/refusals.h"

namespace {

using manager::RestartPolicy;
using Verdict = RestartPolicy::Verdict;
using std::chrono::milliseconds;
using std::chrono::seconds;

const RestartPolicy::Time begin{};

TEST(RestartPolicy, AThirdDeathWithoutATickBetweenIsTheLast) {
  RestartPolicy policy;
  policy.started(begin);
  const auto first = policy.died(begin, false);
  EXPECT_EQ(first.verdict, Verdict::again);
  EXPECT_EQ(first.when, begin);
  const auto second = policy.died(begin, false);
  EXPECT_EQ(second.verdict, Verdict::again);
  EXPECT_EQ(second.when - begin, milliseconds(50));
  EXPECT_EQ(policy.died(begin, false).verdict, Verdict::struck_out);
}

TEST(RestartPolicy, SixStartsAreTooManyWithinTenSecondsAndNotBeyond) {
  for (const bool slow : {false, true}) {
    RestartPolicy policy;
    auto now = begin;
    for (int start = 1; start <= 6; ++start) {
      policy.started(now);
      policy.finished();
      now += slow ? milliseconds(2100) : milliseconds(1600);
      const bool last = start == 6 && !slow;
      EXPECT_EQ(policy.died(now, false).verdict, last ? Verdict::too_often : Verdict::again) << start;
    }
  }
}

TEST(RestartPolicy, GarbageInTwoLivesInARowIsTooOftenWhateverTicksWereFinished) {
  RestartPolicy policy;
  EXPECT_EQ(policy.died(begin, true).verdict, Verdict::again);
  policy.finished();
  EXPECT_EQ(policy.died(begin, false).verdict, Verdict::again);
  policy.finished();
  EXPECT_EQ(policy.died(begin, true).verdict, Verdict::again);
  policy.finished();
  EXPECT_EQ(policy.died(begin, true).verdict, Verdict::too_often);
}

TEST(Refusals, AHundredInARowOrAThousandInTenSeconds) {
  manager::Refusals row;
  for (int i = 0; i < 99; ++i) row.refused(begin);
  EXPECT_FALSE(row.too_many());
  row.refused(begin);
  EXPECT_TRUE(row.too_many());
  for (const int apart : {10, 11}) {
    manager::Refusals lately;
    for (int i = 0; i < 1000; ++i) {
      lately.refused(begin + milliseconds(i * apart));
      lately.accepted();
    }
    EXPECT_EQ(lately.too_many(), apart == 10);
  }
}

TEST(OwnRate, TicksOfAProgramAreAsManyAsItsRateSays) {
  // over a second; the steps that it is told add up to it
  for (const double hertz : {0.0, 1.0, 7.0, 24.0, 30.0, 59.0, 60.0, 100.0}) {
    const manager::OwnRate rate{hertz};
    int count = 0;
    double covered = 0;
    std::uint64_t last = 0;
    for (std::uint64_t tick = 1; tick <= 60; ++tick)
      if (rate.due(tick, 60)) {
        covered += last == 0 ? static_cast<double>(tick) / 60 : rate.step(tick, last, 1.0 / 60);
        last = tick;
        ++count;
      }
    EXPECT_EQ(count, hertz > 0 && hertz < 60 ? hertz : 60);
    EXPECT_NEAR(covered, 1, 1e-12) << hertz;
  }
}

TEST(Answer, IsWholeOnlyAfterTheDoneThatIsOwed) {
  manager::Answer answer;
  EXPECT_FALSE(answer.done("done 7").ok());
  answer.expect_tick(7);
  ASSERT_TRUE(answer.add("set a.b 1").ok());
  for (const char* wrong : {"done 6", "done 8", "done", "done x", "done 7 7", "done 99999999999999999999"})
    EXPECT_FALSE(answer.done(wrong).ok()) << wrong;
  EXPECT_FALSE(answer.take());
  EXPECT_TRUE(answer.owed());
  ASSERT_TRUE(answer.done("done 7").ok());
  EXPECT_FALSE(answer.done("done 7").ok());
  EXPECT_EQ(answer.take(), "set a.b 1\n");
  EXPECT_FALSE(answer.take());
}

}  // namespace
