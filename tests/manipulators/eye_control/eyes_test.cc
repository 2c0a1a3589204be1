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
        "drift_speed 0.003");
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
  std::vector<std::string> left;
  for (double rate : {30.0, 60.0, 90.0, 144.0}) {
    Dialogue d;
    d.say("@1 gaze sailor ball");
    d.run(0.5, rate);
    d.say("set ball.position -0.5 1.7 1");
    d.run(1, rate);
    d.say("set sailor/head.orientation 0.98 0 0.2 0");
    d.run(1.5, rate);
    left.push_back(last(d.answers(), "sailor/left_eye.orientation"));
  }
  EXPECT_NE(left[0], "");
  for (const std::string& orientation : left) EXPECT_EQ(orientation, left[0]);
}

TEST(Eyes, GoOnFromACheckpointBitForBit) {
  const auto begin = [](Dialogue& d) {
    d.say("@1 gaze sailor ball");
    d.run(0.5);
    d.say("set ball.position -0.5 1.7 1");
    d.run(0.65);
  };
  Dialogue whole;
  begin(whole);
  whole.say("checkpoint");
  whole.run(1.2);
  const auto answers = whole.answers();

  // a second life: the same objects as they stood, the private fields as they were written, and only the later ticks
  Dialogue again;
  Dialogue first;
  begin(first);
  first.say("checkpoint");
  for (const std::string& line : first.answers()) {
    if (!line.starts_with("set sailor/gaze.memory_") && !line.starts_with("set sailor/left_eye.orientation") &&
        !line.starts_with("set sailor/gaze.target")) {
      continue;
    }
    EXPECT_LT(line.size(), 65536u);
    again.say(line);
  }
  again.say("set ball.position -0.5 1.7 1");
  for (int tick = 40; tick <= 72; ++tick) {
    char line[100];
    std::snprintf(line, sizeof line, "tick %d %.17g %.17g", tick, tick / 60.0, 1 / 60.0);
    again.say(line);
  }
  const auto later = again.answers();
  for (const char* field : {"sailor/left_eye.orientation", "sailor/right_eye.orientation", "sailor/gaze.vergence"}) {
    EXPECT_EQ(last(later, field), last(answers, field)) << field;
    EXPECT_NE(last(later, field), "") << field;
  }
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
