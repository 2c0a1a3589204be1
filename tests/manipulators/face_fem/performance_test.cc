#include "manipulators/face_fem/performance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "manipulators/face_fem/speech.h"

namespace face {
namespace {

Gesture gesture(const std::string& name, double amount, Envelope envelope) {
  Gesture made;
  made.channel = name;
  made.amount = amount;
  made.envelope = envelope;
  const std::string_view word = name;
  made.parts = *parse_parts({&word, 1});
  return made;
}

int place(std::string_view word) { return (*places_of(word))[0]; }

constexpr double tick = 1.0 / 60;

TEST(ActionUnits, WordsNamePlacesAndBack) {
  for (int p = 0; p < 2 * int(action_units().size()); ++p) {
    const auto places = places_of(word_of_place(p));
    ASSERT_TRUE(places);
    EXPECT_TRUE(std::find(places->begin(), places->end(), p) != places->end()) << word_of_place(p);
  }
  EXPECT_EQ(places_of("AU12")->size(), 2u);
  EXPECT_EQ(places_of("AU12L")->size(), 1u);
  EXPECT_EQ(places_of("AU26")->size(), 2u);
  EXPECT_FALSE(places_of("AU26L"));
  EXPECT_FALSE(places_of("AU3"));
  EXPECT_FALSE(places_of("au12"));
}

TEST(Expressions, EveryNameOfTheTableHasParts) {
  for (const NamedExpression& expression : named_expressions()) {
    const Parts parts = parts_of(expression);
    if (expression.name != "closed") {
      EXPECT_FALSE(parts.empty()) << expression.name;
    }
    for (const auto& [place, level] : parts) {
      EXPECT_GT(level, 0) << expression.name;
      EXPECT_LE(level, 1) << expression.name;
    }
  }
}

TEST(Expressions, WrongWordsAreNamed) {
  const auto error = [](std::string_view word) { return parse_parts({&word, 1}).error(); };
  EXPECT_EQ(error("smlle=1").kind, objdb::ErrorKind::unknown);
  EXPECT_NE(error("smlle=1").sentence.find("did you mean smile"), std::string::npos);
  EXPECT_EQ(error("smile=1.2").kind, objdb::ErrorKind::range);
  EXPECT_EQ(error("smile=-0.1").kind, objdb::ErrorKind::range);
  EXPECT_EQ(error("smile=nan").kind, objdb::ErrorKind::type);
  EXPECT_EQ(error("smile=0.5m").kind, objdb::ErrorKind::unit);
  EXPECT_EQ(error("=1").kind, objdb::ErrorKind::syntax);
  EXPECT_EQ(error("AU3=1").kind, objdb::ErrorKind::unknown);
}

TEST(Envelope, RisesStaysAndFallsWithoutJumpsInAcceleration) {
  const Envelope envelope{1, 0.2, 2, 0.4};
  EXPECT_EQ(envelope.at(1), 0);
  EXPECT_NEAR(envelope.at(1.1), 0.5, 1e-14);
  EXPECT_NEAR(envelope.at(1.2), 1, 1e-14);
  EXPECT_EQ(envelope.at(2), 1);
  EXPECT_NEAR(envelope.at(2.2), 0.5, 1e-14);
  EXPECT_NEAR(envelope.at(2.4), 0, 1e-14);
  // the peak speed of a least-jerk course is 15/8 of the mean one; its acceleration is continuous
  const double h = 1e-5;
  double fastest = 0, jump = 0, before = 0;
  for (double t = 0.9; t < 2.6; t += 1e-4) {
    fastest = std::max(fastest, std::abs(envelope.at(t + h) - envelope.at(t - h)) / (2 * h));
    const double a = (envelope.at(t + h) - 2 * envelope.at(t) + envelope.at(t - h)) / (h * h);
    jump = std::max(jump, std::abs(a - before));
    before = a;
  }
  EXPECT_NEAR(fastest, 1.875 / 0.2, 1e-3);
  // jerk is at most 60 / T^3, so a step of 0.1 ms changes the acceleration by no more than 0.75 1/s2
  EXPECT_LT(jump, 60 / std::pow(0.2, 3) * 1.1e-4 + 1e-3);
}

TEST(Performance, TakingOverWithinAChannelIsOneCourse) {
  Performance play;
  play.begin(gesture("AU12L", 0.4, {0, 0.2}));
  for (int k = 0; k < 60; ++k) play.advance(k * tick, (k + 1) * tick);
  play.begin(gesture("AU12L", 1, {0, 0.3}));
  for (int k = 60; k < 90; ++k) {
    const Levels levels = play.advance(k * tick, (k + 1) * tick);
    const double s = ((k + 1) * tick - 1) / 0.3;
    EXPECT_NEAR(levels[std::size_t(place("AU12L"))], 0.4 + 0.6 * least_jerk(s), 1e-12);
    EXPECT_EQ(levels[std::size_t(place("AU12R"))], 0);
  }
}

TEST(Performance, ChannelsBlendWithoutPassingOne) {
  Performance play;
  play.begin(gesture("AU4", 0.8, {0, 0.1}));
  play.begin(gesture("frown", 1, {0, 0.1}));
  play.begin(gesture("anger", 0.5, {0, 0.1}));
  const Levels levels = play.advance(0, 1);
  const auto p = std::size_t(place("AU4"));
  EXPECT_DOUBLE_EQ(levels[p], 1);
  for (double level : levels) EXPECT_LE(level, 1);
  play.relax(0.5);
  EXPECT_LT(play.advance(1, 1.25)[p], 0.95);
  EXPECT_EQ(play.advance(1.25, 1.5)[p], 0);
  EXPECT_TRUE(play.idle());
}

TEST(Performance, MemoryGoesOnWithTheSameBits) {
  Performance play;
  play.begin(gesture("smile", 0.7, {0, 0.3, 2, 0.5}));
  play.begin(gesture("AU4L", 0.3, {0, 0.2}));
  for (int k = 0; k < 30; ++k) play.advance(k * tick, (k + 1) * tick);
  const std::string_view said[] = {"m", "a=200ms", "o"};
  play.begin_all(*utterance(said, 0.15, 1), 0.1);
  Performance other;
  ASSERT_TRUE(other.recall(play.memory().first, play.memory().second));
  for (int k = 30; k < 200; ++k) {
    if (k == 60) {
      play.relax(0.2);
      other.relax(0.2);
      Performance third;
      ASSERT_TRUE(third.recall(other.memory().first, other.memory().second));
      other = third;
    }
    EXPECT_EQ(play.advance(k * tick, (k + 1) * tick), other.advance(k * tick, (k + 1) * tick)) << k;
    EXPECT_EQ(play.playing(), other.playing());
  }
}

TEST(Performance, GarbledMemoryIsRefused) {
  Performance play;
  play.begin(gesture("smile", 0.7, {0, 0.3, 2, 0.5}));
  play.advance(0, tick);
  const auto [words, numbers] = play.memory();
  Performance other;
  for (std::size_t cut = 0; cut < numbers.size(); ++cut)
    EXPECT_FALSE(other.recall(words, {numbers.begin(), numbers.begin() + std::ptrdiff_t(cut)})) << cut;
  EXPECT_FALSE(other.recall({}, numbers));
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    std::vector<double> bad = numbers;
    bad[k] = 1e300;
    other.recall(words, bad);
    for (double level : other.advance(0, 1)) EXPECT_GE(level, 0);
  }
  EXPECT_TRUE(Performance().recall(words, numbers));
}

TEST(Speech, NeighboursSumToOneAndEachIsReached) {
  const std::string_view said[] = {"a", "m=80ms", "a"};
  const auto gestures = utterance(said, 0.2, 1);
  ASSERT_TRUE(gestures);
  const double end = gestures->back().envelope.end;
  for (double t = (*gestures)[0].envelope.onset; t < end; t += 1e-3) {
    double sum = 0;
    for (const Gesture& one : *gestures) sum += one.envelope.at(t);
    EXPECT_NEAR(sum, 1, 1e-12) << t;
  }
  const Envelope& m = (*gestures)[1].envelope;
  EXPECT_EQ(m.at(0.5 * (m.begin + m.onset + m.end)), 1);
}

TEST(Speech, WrongWordsAreNamed) {
  const auto error = [](std::string_view word) { return utterance({&word, 1}, 0.1, 1).error(); };
  EXPECT_EQ(error("smile").kind, objdb::ErrorKind::unknown);
  EXPECT_EQ(error("a=0s").kind, objdb::ErrorKind::range);
  EXPECT_EQ(error("a=3kg").kind, objdb::ErrorKind::unit);
  EXPECT_EQ(utterance({}, 0.1, 1).error().kind, objdb::ErrorKind::syntax);
}

}  // namespace
}  // namespace face
