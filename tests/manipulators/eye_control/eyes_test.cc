#include "manipulators/eye_control/eyes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

// The program as the dialog manager meets it: lines in, lines out.
namespace eye::test {
namespace {

namespace fs = std::filesystem;

class Dialogue {
 public:
  Dialogue() {
    say("hello protocol=1 name=eye_control seed=7 tick=0.016666666666666666 arrays=text");
    say("type neck extends node");
    say("field neck.target ref:node");
    say("field neck.point vec3 m");
    say("field neck.active bool = false");
    say("create node sailor");
    say("create node sailor/head parent sailor position 0 1.6 0");
    say("create eye sailor/left_eye parent sailor/head position 0.03 0.03 0.085");
    say("create eye sailor/right_eye parent sailor/head position -0.03 0.03 0.085");
    say("create neck sailor/neck");
    say("create gaze sailor/gaze left sailor/left_eye right sailor/right_eye head sailor/head later_sigma 1 "
        "drift_speed 0.003 microsaccade_rate 1.5 blink_rate 1 slip_noise 0.002 listing_tilt 0.25");
    say("create node ball position 0.2 1.63 2");
  }

  void say(const std::string& line) { lines_ += line + "\n"; }

  // ticks of 1 / rate until `end`
  void run(double end, double rate = 60) {
    while (tick_ < std::llround(end * rate)) {
      ++tick_;
      char line[100];
      std::snprintf(line, sizeof line, "tick %lld %.17g %.17g", tick_, static_cast<double>(tick_) / rate, 1 / rate);
      say(line);
    }
  }

  // as if the ticks up to this one had been
  void skip(long long tick) { tick_ = tick; }

  // everything that the program answered
  std::vector<std::string> answers() {
    const fs::path folder = fs::temp_directory_path() / ("eyes_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "in") << lines_ << "quit\n";
    const std::string command =
        std::string(BIN_DIR) + "/eye_control < " + (folder / "in").string() + " > " + (folder / "out").string();
    status_ = std::system(command.c_str());
    std::ifstream in(folder / "out");
    std::vector<std::string> result;
    for (std::string line; std::getline(in, line);) result.push_back(line);
    fs::remove_all(folder);
    return result;
  }

  int status() const { return status_; }

 private:
  std::string lines_;
  long long tick_ = 0;
  int status_ = -1;
};

// the last value that was said of a field; "" if none
std::string last(const std::vector<std::string>& answers, const std::string& field) {
  const std::string start = "set " + field + " ";
  for (auto line = answers.rbegin(); line != answers.rend(); ++line) {
    if (line->starts_with(start)) return line->substr(start.size());
  }
  return "";
}

TEST(Eyes, LookWhereTheyAreTold) {
  Dialogue d;
  d.say("@1 gaze sailor ball");
  d.run(1);
  const auto answers = d.answers();
  EXPECT_EQ(d.status(), 0);
  EXPECT_NE(std::find(answers.begin(), answers.end(), "ready"), answers.end());
  EXPECT_NE(std::find(answers.begin(), answers.end(), "@1 ok"), answers.end());
  EXPECT_EQ(last(answers, "sailor/gaze.status"), "ok");
  EXPECT_LT(std::stod(last(answers, "sailor/gaze.gaze_error")), 0.6 * deg);
  // the ball is to the left: azimuth, right positive, is negative
  EXPECT_LT(std::stod(last(answers, "sailor/left_eye.azimuth")), -0.05);
  // every tick is answered once
  EXPECT_EQ(std::count_if(answers.begin(), answers.end(), [](const auto& l) { return l.starts_with("done "); }), 60);
}

TEST(Eyes, TakePartInTheLookOfTheNeck) {
  Dialogue d;
  d.say("set sailor/neck.target ball");
  d.say("set sailor/neck.active true");
  d.run(1);
  EXPECT_LT(std::stod(last(d.answers(), "sailor/gaze.gaze_error")), 0.6 * deg);
  Dialogue point;
  point.say("set sailor/neck.point -0.3 1.5 1");
  point.say("set sailor/neck.active true");
  point.run(1);
  const auto answers = point.answers();
  EXPECT_LT(std::stod(last(answers, "sailor/gaze.gaze_error")), 0.6 * deg);
  EXPECT_GT(std::stod(last(answers, "sailor/left_eye.azimuth")), 0.1);
}

TEST(Eyes, TheTickRateChangesNoBit) {
  // jumps, a head that is put elsewhere, a near target that calls for vergence; all that is random is on
  std::vector<std::string> found;
  for (double rate : {30.0, 60.0, 90.0, 144.0}) {
    Dialogue d;
    d.say("@1 gaze sailor ball");
    d.run(0.5, rate);
    d.say("set ball.position -0.5 1.7 1");
    d.run(1, rate);
    d.say("set sailor/head.orientation 0.98 0 0.2 0");
    d.run(1.5, rate);
    d.say("set ball.position -0.1 1.6 0.4");
    d.run(3, rate);
    const auto answers = d.answers();
    std::string all;
    for (const char* field : {"left_eye.orientation", "right_eye.orientation", "gaze.vergence", "gaze.gaze_error",
                              "gaze.saccades", "gaze.blink"}) {
      all += last(answers, "sailor/" + std::string(field)) + "\n";
    }
    found.push_back(all);
  }
  EXPECT_GT(found[0].size(), 100u);
  for (const std::string& all : found) EXPECT_EQ(all, found[0]);
}

TEST(Eyes, MeetATurningHeadAlikeAtEveryRate) {
  // between ticks a head turns straight, so its course depends on the ticks, but the eyes hold the ball with it
  std::vector<double> azimuth;
  for (double rate : {30.0, 60.0, 90.0, 144.0}) {
    Dialogue d;
    d.say("set sailor/gaze.drift_speed 0");
    d.say("set sailor/gaze.microsaccade_rate 0");
    d.say("set sailor/gaze.blink_rate 0");
    d.say("set sailor/gaze.slip_noise 0");
    d.say("@1 gaze sailor ball");
    d.run(0.5, rate);
    for (long long tick = std::llround(0.5 * rate) + 1; tick <= std::llround(2 * rate); ++tick) {
      const double t = static_cast<double>(tick) / rate - 0.5, half = 0.1 * std::sin(2 * pi * 0.5 * t);
      char line[120];
      std::snprintf(line, sizeof line, "set sailor/head.orientation %.17g 0 %.17g 0", std::cos(half), std::sin(half));
      d.say(line);
      d.run(static_cast<double>(tick) / rate, rate);
    }
    const auto answers = d.answers();
    azimuth.push_back(std::stod(last(answers, "sailor/left_eye.azimuth")) / deg);
    EXPECT_LT(std::stod(last(answers, "sailor/gaze.gaze_error")), 0.8 * deg) << rate;
  }
  for (double a : azimuth) EXPECT_NEAR(a, azimuth.back(), 0.5);
}

// a look at a ball that jumps, comes near, and is met by a head that turns; whatever is random is on
void eventful(Dialogue& d, int from, int to) {
  for (int tick = from; tick <= to; ++tick) {
    if (tick == 1) d.say("@1 gaze sailor ball");
    if (tick == 31) d.say("set ball.position -0.5 1.7 1");
    if (tick == 35) d.say("set ball.position 0.05 1.6 0.4");
    if (tick > 33) {
      const double angle = 0.1 * std::sin(0.2 * (tick - 33));
      char line[120];
      std::snprintf(line, sizeof line, "set sailor/head.orientation %.17g 0 %.17g 0", std::cos(angle), std::sin(angle));
      d.say(line);
    }
    d.run(tick / 60.0);
  }
}

TEST(Eyes, GoOnFromACheckpointBitForBit) {
  Dialogue whole;
  eventful(whole, 1, 240);
  const auto answers = whole.answers();
  for (int stop : {38, 75, 150}) {
    Dialogue first;
    eventful(first, 1, stop);
    first.say("checkpoint");

    // a second life: the same objects as they stood, the private fields as they were written, and only the later ticks
    Dialogue again;
    again.say("set ball.position 0.05 1.6 0.4");
    for (const std::string& line : first.answers()) {
      if (!line.starts_with("set sailor/gaze.memory_") && !line.starts_with("set sailor/left_eye.orientation") &&
          !line.starts_with("set sailor/gaze.target")) {
        continue;
      }
      EXPECT_LT(line.size(), 65536u);
      again.say(line);
    }
    again.skip(stop);
    eventful(again, stop + 1, 240);
    const auto later = again.answers();
    for (const char* field : {"sailor/left_eye.orientation", "sailor/right_eye.orientation", "sailor/gaze.vergence",
                              "sailor/gaze.gaze_error", "sailor/gaze.saccades", "sailor/gaze.blink"}) {
      EXPECT_EQ(last(later, field), last(answers, field)) << field << " from " << stop;
      EXPECT_NE(last(later, field), "") << field;
    }
  }
}

TEST(Eyes, OfManyFiguresAreThoseOfOne) {
  // eleven sailors more, of whom some have other parameters: the first one's eyes do not notice
  const auto eyes = [](bool company) {
    Dialogue d;
    for (int k = 0; company && k < 11; ++k) {
      const std::string name = "other" + std::to_string(k), head = name + "/head";
      d.say("create node " + name + " position " + std::to_string(k) + " 0 0");
      d.say("create node " + head + " parent " + name + " position 0 1.6 0");
      d.say("create eye " + name + "/left parent " + head + " position 0.03 0.03 0.085");
      d.say("create eye " + name + "/right parent " + head + " position -0.03 0.03 0.085");
      d.say("create gaze " + name + "/gaze left " + name + "/left right " + name + "/right head " + head +
            " target ball" + (k % 4 == 0 ? " pursuit_gain 0.8" : ""));
    }
    eventful(d, 1, 120);
    return last(d.answers(), "sailor/left_eye.orientation");
  };
  EXPECT_NE(eyes(false), "");
  EXPECT_EQ(eyes(false), eyes(true));
}

TEST(Eyes, TellWhatIsMissing) {
  Dialogue d;
  d.say("create gaze sailor/other left sailor/left_eye");
  d.say("create gaze sailor/wrong left sailor/left_eye right sailor/right_eye head sailor/head smooth_from 0.5");
  d.say("@1 gaze ball sailor");
  d.say("@2 gaze sailor nobody");
  d.say("@3 gaze sailor");
  d.run(0.1);
  const auto answers = d.answers();
  EXPECT_EQ(last(answers, "sailor/other.status"), "no_eyes");
  EXPECT_EQ(last(answers, "sailor/other.reason"), "\"right names no eye\"");
  EXPECT_EQ(last(answers, "sailor/wrong.status"), "bad_parameter");
  for (const char* tag : {"@1 error unknown", "@2 error unknown", "@3 error syntax"}) {
    EXPECT_TRUE(std::any_of(answers.begin(), answers.end(), [&](const auto& l) { return l.starts_with(tag); })) << tag;
  }
}

TEST(Eyes, SayWhenATargetIsOutOfReach) {
  Dialogue d;
  d.say("set ball.position 2 1.6 -1");
  d.say("@1 gaze sailor ball");
  d.run(1);
  const auto answers = d.answers();
  EXPECT_EQ(last(answers, "sailor/gaze.status"), "out_of_range");
  EXPECT_NEAR(std::stod(last(answers, "sailor/left_eye.azimuth")), -50 * deg, 0.01);
}

TEST(Eyes, SayWhenATargetIsTooNear) {
  Dialogue d;
  d.say("set ball.position 0 1.63 0.09");
  d.say("@1 gaze sailor ball");
  d.run(1);
  const auto answers = d.answers();
  EXPECT_EQ(last(answers, "sailor/gaze.status"), "too_near");
  EXPECT_EQ(last(answers, "sailor/gaze.reason"), "\"the target lies within 2 cm of the eyes\"");
  EXPECT_GT(std::stod(last(answers, "sailor/gaze.gaze_error")), 0.5);
}

TEST(Eyes, ChooseTheirMethodByTheBudget) {
  const std::pair<const char*, const char*> cases[] = {{"budget off", "full"},
                                                       {"budget error 0.1", "snap"},
                                                       {"budget error 0.05", "saccade_only"},
                                                       {"budget error 0.01", "linear"},
                                                       {"budget error 0.001", "full"},
                                                       {"budget time 0.001", "full"},
                                                       {"budget time 0.0000092", "linear"},
                                                       {"budget time 0.000007", "snap"},
                                                       {"budget time 0.0000001", "snap"}};
  for (const auto& [line, method] : cases) {
    Dialogue d;
    d.say("set sailor/gaze.method auto");
    d.say("@1 gaze sailor ball");
    d.say("budget error 0.05");
    d.run(0.1);
    d.say(line);
    d.run(0.2);
    const auto answers = d.answers();
    const std::string used = last(answers, "sailor/gaze.method_used");
    EXPECT_EQ(used.empty() ? "full" : used, method) << line;
    EXPECT_GT(std::stod(last(answers, "sailor/gaze.predicted_time")), 0);
  }
}

TEST(Eyes, SnapIsExactAtTheTick) {
  Dialogue d;
  d.say("set sailor/gaze.method snap");
  d.say("@1 gaze sailor ball");
  d.run(0.5);
  d.say("set ball.position -0.4 1.5 0.8");
  d.run(0.52);
  EXPECT_LT(std::stod(last(d.answers(), "sailor/gaze.gaze_error")), 1e-7);
}

}  // namespace
}  // namespace eye::test
