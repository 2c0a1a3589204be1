#include "manipulators/eye_control/simulate.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

// The command line as a newcomer meets it: files in, one trace out, one sentence when something is wrong.
namespace eye::test {
namespace {

namespace fs = std::filesystem;

class Command : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("eye_control_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) {
    const fs::path path = folder_ / name;
    std::ofstream(path) << text;
    return path.string();
  }

  // exit status; standard error in `said`
  int run(const std::string& arguments) {
    const fs::path errors = folder_ / "errors";
    const std::string command = std::string(BIN_DIR) + "/eye_control " + arguments + " 2> " + errors.string();
    const int status = std::system(command.c_str());
    std::ifstream in(errors);
    said = std::string(std::istreambuf_iterator<char>(in), {});
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  Table trace() {
    std::ifstream in(folder_ / "trace.csv");
    std::string header, line;
    std::getline(in, header);
    Table table;
    std::stringstream names(header);
    while (std::getline(names, line, ',')) table.columns.push_back(line);
    while (std::getline(in, line)) {
      // all but the last cell, which is the mode
      std::vector<double> row;
      std::stringstream cells(line);
      std::string cell;
      while (std::getline(cells, cell, ',')) {
        if (row.size() + 1 < table.columns.size()) {
          row.push_back(std::stod(cell));
        } else {
          modes.push_back(cell);
        }
      }
      table.rows.push_back(row);
    }
    return table;
  }

  std::string out() const { return (folder_ / "trace.csv").string(); }

  fs::path folder_;
  std::string said;
  std::vector<std::string> modes;
};

std::string step_course() {
  std::ostringstream text;
  text << "t_s,azimuth_deg,elevation_deg\n";
  for (int k = 0; k <= 1000; ++k) text << k / 1000.0 << ',' << (k >= 300 ? 10 : 0) << ",0\n";
  return text.str();
}

TEST_F(Command, WritesATraceAtOneKilohertz) {
  ASSERT_EQ(run("--simulate " + file("t.csv", step_course()) + " --out " + out()), 0) << said;
  EXPECT_EQ(said, "");
  const Table t = trace();
  ASSERT_EQ(t.rows.size(), 1001u);
  ASSERT_EQ(t.columns.size(), 10u);
  EXPECT_EQ(t.columns[0], "t_s");
  EXPECT_EQ(t.columns[9], "mode");
  EXPECT_EQ(t.rows[300][0], 0.3);
  // 200 ms after the step the saccade starts, to the right, with both eyes
  EXPECT_EQ(modes[499], "latency");
  EXPECT_EQ(modes[500], "saccade");
  EXPECT_NEAR(t.rows[1000][1], 10, 0.01);
  EXPECT_NEAR(t.rows[1000][4], 10, 0.01);
  EXPECT_NEAR(t.rows[1000][3], 0, 1e-9);
  double fastest = 0;
  for (const auto& row : t.rows) fastest = std::max(fastest, row[7]);
  EXPECT_NEAR(fastest, 300, 10);
}

TEST_F(Command, VelocityIsNegativeToTheLeftAndDown) {
  std::ostringstream text;
  text << "t_s,azimuth_deg,elevation_deg\n";
  for (int k = 0; k <= 800; ++k) text << k / 1000.0 << ',' << (k >= 200 ? -10 : 0) << ',' << (k >= 200 ? 3 : 0) << '\n';
  ASSERT_EQ(run("--simulate " + file("t.csv", text.str()) + " --out " + out()), 0) << said;
  double lowest = 0, highest = 0;
  for (const auto& row : trace().rows) {
    lowest = std::min(lowest, row[7]);
    highest = std::max(highest, row[7]);
  }
  EXPECT_LT(lowest, -250);
  EXPECT_LT(highest, 1);
}

TEST_F(Command, TakesParametersWithUnits) {
  ASSERT_EQ(run("--simulate " + file("t.csv", step_course()) +
                " --set saccade_latency=150ms --set dead_zone=1deg --out " + out()),
            0)
      << said;
  trace();
  EXPECT_EQ(modes[449], "latency");
  EXPECT_EQ(modes[450], "saccade");
}

TEST_F(Command, TakesAHeadAndShowsGazeInTheWorldOrTheHead) {
  std::ostringstream target, head;
  target << "t_s,azimuth_deg,elevation_deg\n0,0,0\n1,0,0\n";
  head << "t_s,azimuth_deg,elevation_deg\n0,0,0\n0.2,0,0\n1,16,0\n";
  const std::string common = "--simulate " + file("t.csv", target.str()) + " --head " + file("h.csv", head.str());
  ASSERT_EQ(run(common + " --out " + out()), 0) << said;
  EXPECT_NEAR(trace().rows[1000][1], 0, 0.8);
  ASSERT_EQ(run(common + " --frame head --out " + out()), 0) << said;
  EXPECT_NEAR(trace().rows[1000][1], -16, 0.8);
}

TEST_F(Command, NearTargetsNeedVergence) {
  ASSERT_EQ(run("--simulate " + file("t.csv", "t_s,azimuth_deg,elevation_deg,distance_m\n0,0,0,0.4\n0.1,0,0,0.4\n") +
                " --out " + out()),
            0)
      << said;
  const Table t = trace();
  EXPECT_NEAR(t.rows[50][1], std::atan(0.0315 / 0.4) / deg, 1e-9);
  EXPECT_NEAR(t.rows[50][4], -std::atan(0.0315 / 0.4) / deg, 1e-9);
}

TEST_F(Command, NamesThePlaceOfBadData) {
  const struct {
    const char* text;
    const char* place;
    const char* word;
  } cases[] = {
      {"t_s,azimuth_deg,elevation_deg\n0,0,0\n0.1,x,0\n", ":3:5: error type", "azimuth_deg"},
      {"t_s,azimuth_deg,elevation_deg\n0,0,0\n0.1,0\n", ":3:1: error syntax", "2 cells"},
      {"t_s,azimuth_deg,elevation_deg\n0.1,0,0\n0,0,0\n", ":3:1: error range", "must not fall"},
      {"t_s,azimuth_deg\n0,0\n", ":1:1: error unknown", "elevation_deg"},
      {"t_s;azimuth_deg;elevation_deg\n0;0;0\n", ":1:1: error unknown", "t_s is missing"},
      {"t_s,azimuth_deg,elevation_deg,t_s\n0,0,0,0\n", ":1:1: error unknown", "t_s is there twice"},
      {"t_s,azimuth_deg,elevation_deg\n,0,0\n", ":2:1: error type", "t_s is empty"},
      {"t_s,azimuth_deg,elevation_deg\n0,0,0\n90000,0,0\n", ":3:1: error range", "expected at most 86400"},
      {"t_s,azimuth_deg,elevation_deg\n0,1e300,0\n", ":2:3: error range", "azimuth_deg must be between"},
      {"t_s,azimuth_deg,elevation_deg\n0,0,100\n", ":2:5: error range", "100"},
      {"t_s,azimuth_deg,elevation_deg,distance_m\n0,0,0,1e-310\n", ":2:7: error", "distance_m"},
      {"t_s,azimuth_deg,elevation_deg\n0,nan,0\n", ":2:3: error type", "nan"},
      {"t_s,azimuth_deg,elevation_deg,distance_m\n0,0,0,0\n", ":2:7: error range", "distance_m"},
      {"t_s,azimuth_deg,elevation_deg\n", ":1:1: error syntax", "no rows"},
      {"", ":1:1: error io", "empty"},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(run("--simulate " + file("bad.csv", c.text) + " --out " + out()), 1) << c.text;
    EXPECT_NE(said.find("bad.csv" + std::string(c.place)), std::string::npos) << said;
    EXPECT_NE(said.find(c.word), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
  EXPECT_EQ(run("--simulate /nowhere/t.csv --out " + out()), 1);
  EXPECT_NE(said.find("error io"), std::string::npos);
  EXPECT_EQ(run("--simulate " + file("t.csv", step_course()) + " --out /nowhere/trace.csv"), 1);
}

TEST_F(Command, RefusesBadUsage) {
  const std::string t = file("t.csv", step_course());
  for (const std::string& arguments : std::vector<std::string>{
           "--simulate " + t, "--bogus", "--simulate " + t + " --set nothing=1 --out " + out(),
           "--simulate " + t + " --set pursuit_gain --out " + out(),
           "--simulate " + t + " --set pursuit_gain=9 --out " + out(),
           "--simulate " + t + " --set visual_delay=3kg --out " + out(),
           "--simulate " + t + " --set method=fast --out " + out(), "--simulate " + t + " --step 0 --out " + out(),
           "--simulate " + t + " --frame moon --out " + out()}) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_NE(said, "") << arguments;
  }
  EXPECT_EQ(run("--simulate " + t + " --set saccade_latensy=1 --out " + out()), 2);
  EXPECT_NE(said.find("saccade_latency"), std::string::npos) << said;
}

}  // namespace
}  // namespace eye::test
