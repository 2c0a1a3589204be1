// The program from outside: command line and pipe.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/head_ik/figure.h"
#include "manipulators/head_ik/zyz.h"
#include "objdb/text.h"

namespace head {
namespace {

struct Outcome {
  int status = -1;
  std::string out, err;
};

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Program : public testing::Test {
 protected:
  void SetUp() override {
    if (access(BIN_DIR "/head_ik", X_OK) != 0) GTEST_SKIP() << "head_ik is not built";
    std::string pattern = (std::filesystem::temp_directory_path() / "head_ik_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder = pattern;
  }
  void TearDown() override {
    if (!folder.empty()) std::filesystem::remove_all(folder);
  }

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
  Outcome run(const std::string& arguments, const std::string& input = "") const {
    const std::string in = file("in", input), out = (folder / "out").string(), err = (folder / "err").string();
    const std::string command = std::string(BIN_DIR "/head_ik ") + arguments + " <" + in + " >" + out + " 2>" + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
  }

  std::filesystem::path folder;
};

constexpr const char* orientation_header = "r11,r12,r13,r21,r22,r23,r31,r32,r33\n";

std::vector<std::vector<std::string>> cells(const std::string& table) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST_F(Program, SolvesOrientations) {
  std::string table = orientation_header;
  const Zyz given[] = {{0.3, 0.5, -0.2}, {0, 0, 0.1}, {1, 1e-9, -0.8}, {0.4, 2.5, 1}, {0, M_PI, 0.3}};
  for (const Zyz& angles : given) {
    const Eigen::Matrix3d R = rotation(angles);
    for (int i = 0; i < 9; ++i) table += objdb::number(R(i / 3, i % 3)) + (i < 8 ? "," : "\r\n");
  }
  const Outcome done = run("--solve " + file("t.csv", table) + " --out " + (folder / "o.csv").string());
  ASSERT_EQ(done.status, 0) << done.err;
  const auto rows = cells(contents(folder / "o.csv"));
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_EQ(rows[0].front(), "alpha_rad");
  for (int n = 0; n < 5; ++n) {
    const auto& row = rows[n + 1];
    ASSERT_EQ(row.size(), 7U);
    const Zyz asked{std::stod(row[0]), std::stod(row[1]), std::stod(row[2])};
    const Zyz limited{std::stod(row[3]), std::stod(row[4]), std::stod(row[5])};
    EXPECT_LE((rotation(asked) - rotation(given[n])).norm(), 2e-15);
    EXPECT_EQ(row[6], n < 3 ? "reached" : "limited");
    if (n < 3) {
      EXPECT_EQ(row[0] + row[1] + row[2], row[3] + row[4] + row[5]);
    }
    EXPECT_LE(limited.beta, 100 * M_PI / 180);
  }
}

TEST_F(Program, SolvesPoints) {
  const Outcome done = run("--solve " + file("t.csv", "x,y,z\n1,0,1\n0,0,0\n0,0,-2\n\n"));
  ASSERT_EQ(done.status, 0) << done.err;
  const auto rows = cells(done.out);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_NEAR(std::stod(rows[1][0]), 0, 1e-15);
  EXPECT_NEAR(std::stod(rows[1][1]), M_PI / 4, 1e-15);
  EXPECT_EQ(rows[1][6], "reached");
  EXPECT_EQ(rows[2][6], "too_near");
  EXPECT_EQ(rows[3][6], "limited");
  EXPECT_NEAR(std::stod(rows[3][4]), 65 * M_PI / 180, 1e-9);
}

TEST_F(Program, NamesThePlaceOfBadData) {
  const struct {
    std::string table, place, kind;
  } bad[] = {{"", ":0:0", "syntax"},
             {"a,b\n", ":1:1", "syntax"},
             {"x,y,z\n1,2\n", ":2:3", "syntax"},
             {"x,y,z\n1,2,3,4\n", ":2:5", "syntax"},
             {"x,y,z\n1,2,3\n1,,3\n", ":3:3", "type"},
             {"x,y,z\n1,2,nan\n", ":2:5", "type"},
             {"x,y,z\n1,2,1e999\n", ":2:5", "type"},
             {"x,y,z\n1,0x2,3\n", ":2:3", "type"},
             {std::string(orientation_header) + "1,0,0,0,1,0,0,0,-1\n", ":2:1", "range"},
             {std::string(orientation_header) + "2,0,0,0,1,0,0,0,1\n", ":2:1", "range"}};
  for (const auto& [table, place, kind] : bad) {
    const std::string name = file("bad.csv", table);
    const Outcome done = run("--solve " + name);
    EXPECT_EQ(done.status, 1) << table;
    EXPECT_EQ(done.err.rfind(name + place + ": error " + kind + " ", 0), 0U) << done.err;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1);
  }
  EXPECT_EQ(run("--solve " + (folder / "none.csv").string()).status, 1);
  EXPECT_EQ(run("--solve " + folder.string()).status, 1);
  EXPECT_EQ(run("--solve " + file("t.csv", "x,y,z\n1,2,3\n") + " --out " + (folder / "no/o.csv").string()).status, 1);
  EXPECT_EQ(run("--solve " + file("t.csv", "x,y,z\n1,2,3\n") + " --out /dev/full").status, 1);
}

TEST_F(Program, RefusesBadOptions) {
  for (const char* arguments : {"--bogus", "--figure-neck huge", "--scale 0 --figure-neck full", "--out x", "--solve"})
    EXPECT_EQ(run(arguments).status, 2) << arguments;
  EXPECT_EQ(run("--help").status, 0);
}

// -- at the end of a pipe

class Pipe : public Program {
 protected:
  static constexpr const char* hello = "hello protocol=1 name=head_ik seed=0 tick=0.02\n";
  // an actor turned and moved away from the origin, a ball in front of him and 40 degrees to the left
  static std::string world(const std::string& memory = "") {
    std::string lines =
        "create node sailor position 3 0 -2 orientation 0.8 0 0.6 0\ncreate node sailor/thorax position 0 1.4 0\n";
    std::istringstream script(
        figure_script(full_neck(), {"sailor/neck_", "sailor/thorax", "sailor/head"}, {0, 0.1, 0}));
    for (std::string line; std::getline(script, line);) {
      // references are told in lines of their own
      std::istringstream words(line);
      std::string create, type, name, parent, above, rest;
      words >> create >> type >> name >> parent >> above;
      std::getline(words, rest);
      lines += create + " " + type + " " + name + rest + "\nset " + name + ".parent " + above + "\n";
    }
    lines +=
        "create neck sailor/neck" + memory + "\nset sailor/neck.root sailor/thorax\nset sailor/neck.tip sailor/head\n";
    return lines + "create node ball position 5 1.7 -2.2\n";
  }
  static std::string ticks(int first, int last, double step = 0.02) {
    std::string lines;
    for (int n = first; n <= last; ++n)
      lines += "tick " + std::to_string(n) + " " + objdb::number(n * step) + " " + objdb::number(step) + "\n";
    return lines;
  }
  // the last value that was said of a field
  static std::string value(const std::string& said, const std::string& field) {
    const std::size_t at = said.rfind("set " + field + " ");
    if (at == std::string::npos) return "";
    const std::size_t begin = at + field.size() + 5;
    return said.substr(begin, said.find('\n', begin) - begin);
  }
};

TEST_F(Pipe, SaysWhatItBringsAndMovesTheHead) {
  const Outcome done = run("", hello + world() + ticks(1, 10) + "set sailor/neck.share full\n@1 look sailor ball\n" +
                                   ticks(11, 200) + "quit\n");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.err, "");
  EXPECT_NE(done.out.find("type neck extends node"), std::string::npos);
  EXPECT_NE(done.out.find("\nready\n"), std::string::npos);
  EXPECT_NE(done.out.find("\n@1 ok\n"), std::string::npos);
  EXPECT_NE(done.out.find("set sailor/neck.status waiting"), std::string::npos);
  EXPECT_EQ(value(done.out, "sailor/neck.status"), "reached");
  EXPECT_LT(std::stod(value(done.out, "sailor/neck.gaze_error")), 1e-6);
  EXPECT_GT(std::abs(std::stod(value(done.out, "sailor/neck_c1_2_axial.angle"))), 0.05);
  EXPECT_NE(done.out.find("done 200\n"), std::string::npos);
}

TEST_F(Pipe, GoesOnFromACheckpointAsIfNothingHadHappened) {
  const std::string look = "@1 look sailor ball\n";
  const std::string later = "set ball.position 1 2 -4\n" + ticks(26, 120);
  const Outcome whole = run("", hello + world() + look + ticks(1, 25) + "checkpoint\n" + later);
  const std::string memory = value(whole.out, "sailor/neck.memory");
  ASSERT_FALSE(memory.empty()) << whole.out;

  // a fresh process is told the world of the checkpoint, then what came after it
  std::string again = hello + world(" active true");
  again += "set sailor/neck.target ball\nset sailor/neck.memory " + memory + "\nset sailor/neck.remembered ball\n";
  const Neck neck = full_neck();
  for (const Level& level : neck.levels())
    for (int k = 0; k < 3; ++k) {
      const std::string field =
          "sailor/neck_" + level.name + "_" + std::string(name_of(static_cast<Freedom>(k))) + ".angle";
      const std::string angle = value(whole.out.substr(0, whole.out.find("done 25\n")), field);
      if (!angle.empty()) again += "set " + field + " " + angle + "\n";
    }
  const Outcome resumed = run("", again + later);
  const auto from = [](const std::string& text) { return text.substr(text.find("set", text.find("done 60\n"))); };
  const auto unmeasured = [](const std::string& text) {
    std::istringstream lines(text);
    std::string kept;
    for (std::string line; std::getline(lines, line);)
      if (line.find(".elapsed ") == std::string::npos) kept += line + "\n";
    return kept;
  };
  EXPECT_EQ(unmeasured(from(resumed.out)), unmeasured(from(whole.out)));
}

TEST_F(Pipe, AnswersWrongCommandsInOneLine) {
  const Outcome done =
      run("", hello + world() +
                  "create node lamp\n"
                  "@1 look lamp ball\n@2 look nobody ball\n@3 look sailor nothing\n@4 look sailor 1 2\n"
                  "@5 look sailor 1 2 3kg\n@6 look\n@7 look sailor 1cm 2m 3\n@8 look sailor/neck away\n");
  for (const char* answer : {"@1 error unknown 9 ", "@2 error unknown 9 ", "@3 error unknown 16 ", "@4 error syntax ",
                             "@5 error unit 20 ", "@6 error syntax ", "@7 ok\n", "@8 ok\n"})
    EXPECT_NE(done.out.find(std::string("\n") + answer), std::string::npos) << answer << "\n" << done.out;
  EXPECT_EQ(value(done.out, "sailor/neck.point"), "0.01 2 3");
}

TEST_F(Pipe, LosesSightOfADeletedTarget) {
  const Outcome done =
      run("", hello + world() + "@1 look sailor ball\n" + ticks(1, 60) + "delete ball force\n" + ticks(61, 200));
  EXPECT_EQ(value(done.out, "sailor/neck.status"), "no_target");
  EXPECT_EQ(value(done.out, "sailor/neck.active"), "false");
  EXPECT_LT(std::abs(std::stod(value(done.out, "sailor/neck_c1_2_axial.angle"))), 1e-6);
}

TEST_F(Pipe, SaysWhatIsWrongWithAChain) {
  const struct {
    std::string change, reason;
  } faults[] = {
      {"set sailor/neck.tip -", "tip names no node"},
      {"set sailor/neck.root ball", "sailor/head does not stand below ball"},
      {"set sailor/neck.tip sailor/neck_c0_1_lateral", "the top level has no joint ..._axial"},
      {"set sailor/neck_c5_6_axial.orientation 0.9 0.1 0 0", "is not parallel to the one of the lowest level"},
      {"set sailor/neck_c5_6_axial.position 0.1 0 0", "does not meet the other axes of its level"},
      {"set sailor/neck_c5_6_axial.rest 2", "has its rest angle outside its limits"}};
  for (const auto& [change, reason] : faults) {
    const Outcome done = run("", hello + world() + "@1 look sailor ball\n" + ticks(1, 5) + change + "\n" + ticks(6, 7));
    EXPECT_EQ(value(done.out, "sailor/neck.status"), "no_chain") << change;
    EXPECT_NE(value(done.out, "sailor/neck.reason").find(reason), std::string::npos)
        << value(done.out, "sailor/neck.reason");
    EXPECT_NE(done.out.find("done 7\n"), std::string::npos);
  }
}

TEST_F(Pipe, StartsWhereTheJointsAre) {
  const Outcome done =
      run("", hello + world() + "set sailor/neck_c1_2_axial.angle 0.3\nset sailor/neck_c2_3_axial.angle 0.02\n" +
                  ticks(1, 1));
  // 0.32 rad of axial total, spread by the shares of the limits: C1-2 takes 33.782 of 65 degrees
  EXPECT_NEAR(std::stod(value(done.out, "sailor/neck_c1_2_axial.angle")), 0.32 * 33.782 / 65, 1e-3);
}

}  // namespace
}  // namespace head
