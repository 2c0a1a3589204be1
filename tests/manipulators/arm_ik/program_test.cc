#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

// The program from outside: command lines, files, and the conversation of a manipulator.

namespace {

const std::string program = std::string(BIN_DIR) + "/arm_ik";

struct Outcome {
  int status;
  std::string out;  // both streams
};

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "arm_ik_program_" + std::to_string(getpid()) + "/";
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ + name) << text;
    return folder_ + name;
  }
  Outcome run(const std::string& arguments, const std::string& input = "") {
    const std::string command = program + " " + arguments + " < " + write("input", input) + " 2>&1";
    FILE* pipe = popen(command.c_str(), "r");
    Outcome outcome{};
    char buffer[4096];
    for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.out.append(buffer, n);
    outcome.status = WEXITSTATUS(pclose(pipe));
    return outcome;
  }
  std::string folder_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

TEST_F(Program, SolvesAFileOfTargetsInOrder) {
  const std::string targets = write("t.csv", "x,y,z\n0.3,-0.1,-0.4\n3,0,0\n0.4,-0.2,-0.3\n");
  const Outcome outcome = run("--solve arm11 " + targets);
  EXPECT_EQ(outcome.status, 0);
  const auto lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_TRUE(lines[0].starts_with("status,method,position_error_m,rotation_error_rad,iterations,time_us,q1_rad,"));
  EXPECT_TRUE(lines[1].starts_with("reached,")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("unreachable,")) << lines[2];
  EXPECT_TRUE(lines[3].starts_with("reached,")) << lines[3];
  EXPECT_EQ(std::count(lines[1].begin(), lines[1].end(), ','), 16);
}

TEST_F(Program, WritesTheSameAnswersEveryTimeButForTheirTime) {
  const std::string targets = write("t.csv", "x,y,z,qw,qx,qy,qz\n0.3,-0.1,-0.4,1,0,0,0\n0.3,0.1,-0.4,0.6,0.8,0,0\n");
  const auto answers = [&] {
    std::string all;
    for (const std::string& line : lines_of(run("--solve arm11 " + targets + " --start random --seed 5").out)) {
      std::istringstream in(line);
      int column = 0;
      for (std::string cell; std::getline(in, cell, ','); ++column) all += column == 5 ? "" : cell + ",";
    }
    return all;
  };
  EXPECT_EQ(answers(), answers());
}

TEST_F(Program, SaysWhereAFileIsWrong) {
  const auto fault = [&](const std::string& text) {
    const Outcome outcome = run("--solve arm11 " + write("t.csv", text));
    EXPECT_EQ(outcome.status, 1) << text;
    EXPECT_EQ(lines_of(outcome.out).size(), 1u) << outcome.out;
    return outcome.out.substr(folder_.size());
  };
  EXPECT_EQ(fault("x,y\n1,2\n"),
            "t.csv:1:1: error syntax the header has 2 columns, expected 3 (x,y,z), 7 (and qw,qx,qy,qz) or 18 (and a "
            "start of 11 joints)\n");
  EXPECT_EQ(fault("x,y,z\n1,2\n"), "t.csv:2:1: error syntax the row has 2 cells, expected 3\n");
  EXPECT_EQ(fault("x,y,z\n1,2,3\n1,2,inf\n"), "t.csv:3:5: error range z is inf, expected a finite number\n");
  EXPECT_EQ(fault("x,y,z\n1,2,1e999\n"), "t.csv:2:5: error range z is 1e999, expected a finite number\n");
  EXPECT_EQ(fault("x,y,z\n1,-2e9,3\n"), "t.csv:2:3: error range y is -2e9, expected within 1e9 m\n");
  EXPECT_EQ(fault("x,y,z,qw,qx,qy,qz\n1,2,3,0,0,0,0\n"),
            "t.csv:2:7: error range the quaternion's length is 0.000000, expected 1\n");
  EXPECT_EQ(fault("x,y,z\n"), "t.csv:1:1: error syntax no targets, expected at least one row\n");
}

// one joint, thirty, slides only, links of a nanometre, of nothing, turns without end
TEST_F(Program, SolvesTheOddestChains) {
  const std::string header = "joint,theta0_deg,d_m,a_m,alpha_deg,lower_deg,upper_deg,rest_deg\n";
  std::string thirty = header;
  for (int i = 0; i < 30; ++i) thirty += "j" + std::to_string(i) + ",0,0,0.1," + (i % 2 ? "90" : "0") + ",-60,60,0\n";
  const std::string targets = write("t.csv", "x,y,z\n1,0,0\n0.6,0.8,0\n5,5,5\n1e9,0,0\n");
  const auto words = [&](const std::string& text) {
    std::string all;
    for (const std::string& line : lines_of(run("--solve " + write("chain.csv", text) + " " + targets).out))
      all += line.substr(0, line.find(',')) + " ";
    return all.substr(all.find(' ') + 1);
  };
  EXPECT_EQ(words(header + "a,0,0,1,0,-180,180,0\n"), "reached reached unreachable unreachable ");
  EXPECT_EQ(words(header + "a,0,0,1,0,-1e9,1e9,0\n"), "reached reached unreachable unreachable ");
  EXPECT_EQ(words(header + "a,0,0,1,0,0,0,0\n"), "reached limited unreachable unreachable ");
  EXPECT_EQ(words(header + "a,0,0,0,0,-9,9,0\n"), "unreachable unreachable unreachable unreachable ");
  EXPECT_EQ(words(header + "a,0,0,1e-9,0,-9,9,0\n"), "unreachable unreachable unreachable unreachable ");
  EXPECT_EQ(words(thirty), "reached reached unreachable unreachable ");
  const std::string far = run("--solve " + write("chain.csv", header + "a,0,0,1e300,0,-9,9,0\n") + " " + targets).out;
  EXPECT_EQ(far.substr(folder_.size()), "chain.csv:2:7: error range a_m of \"a\" is 1e300, expected within 1e9\n");
  std::string slides = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>";
  slides += "<joint name='x' type='prismatic'><parent link='a'/><child link='b'/><axis xyz='1 0 0'/>";
  slides += "<limit lower='0' upper='2' effort='1' velocity='1'/></joint>";
  slides += "<joint name='y' type='prismatic'><parent link='b'/><child link='c'/><axis xyz='0 1 0'/>";
  slides += "<limit lower='0' upper='2' effort='1' velocity='1'/></joint></robot>";
  const std::vector<std::string> rows =
      lines_of(run("--solve " + write("slides.urdf", slides) + " " + targets + " --base a --tip c").out);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_TRUE(rows[2].starts_with("reached,")) << rows[2];
  EXPECT_TRUE(rows[3].starts_with("unreachable,")) << rows[3];
}

TEST_F(Program, RefusesBadUsageWithStatusTwo) {
  const std::string targets = write("t.csv", "x,y,z\n1,2,3\n");
  for (const std::string arguments :
       {"--solve arm11", "--nonsense", "--method full", "--solve arm11 T --method quick",
        "--solve arm11 T --budget 1kg", "--solve arm11 T --position-tolerance 0", "--solve a.urdf T",
        "--solve arm11 T --start nowhere", "--solve arm12 T", "--solve arm11 T --base thorax",
        "--solve arm11 T --seed -1", "--solve arm11 T --budget 0", "--solve arm11 T --rotation-tolerance nan"}) {
    std::string line = arguments;
    if (const auto at = line.find(" T"); at != std::string::npos) line.replace(at, 2, " " + targets);
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.status, 2) << arguments << ": " << outcome.out;
    EXPECT_FALSE(outcome.out.empty());
  }
  EXPECT_EQ(run("--help").status, 0);
}

// the conversation of a manipulator, both sides of it
class Conversation : public Program {
 protected:
  static std::string world() {
    return "hello protocol=1 name=arm_ik seed=1 tick=0.016666666666666666 arrays=shm schema=0\n"
           "create node sailor\ncreate node sailor/thorax position 0 1.4 0\n";
  }
  static std::string ticks(int from, int count) {
    std::string out;
    for (int t = from; t < from + count; ++t) {
      out += "tick " + std::to_string(t) + " " + std::to_string(t / 60.0) + " 0.016666666666666666\n";
    }
    return out;
  }
  std::string arm() { return run("--figure right").out; }
  // the last value that was said of a field
  static std::string last(const std::string& said, const std::string& field) {
    std::string value;
    for (const std::string& line : lines_of(said)) {
      if (line.starts_with("set " + field + " ")) value = line.substr(field.size() + 5);
    }
    return value;
  }
};

TEST_F(Conversation, DeclaresReachesAndStops) {
  const std::string said = run("", world() + arm() + "create sphere ball position -0.3 1.3 0.3\n" + ticks(1, 1) +
                                       "@7 reach sailor/right_arm ball\n" + ticks(2, 120) +
                                       "@8 reach sailor/right_arm none\n" + ticks(122, 2) + "quit\n")
                               .out;
  EXPECT_NE(said.find("type arm extends node"), std::string::npos);
  EXPECT_NE(said.find("\nready\n"), std::string::npos);
  EXPECT_NE(said.find("\n@7 ok\n"), std::string::npos);
  EXPECT_NE(said.find("set sailor/right_arm.status moving\n"), std::string::npos);
  EXPECT_NE(said.find("set sailor/right_arm.status reached\n"), std::string::npos);
  EXPECT_EQ(last(said, "sailor/right_arm.status"), "idle");
  EXPECT_NE(said.find("\ndone 123\n"), std::string::npos);
}

TEST_F(Conversation, IncompleteArmsAreStatesNotErrors) {
  const std::string said = run("", world() + "create arm lonely\ncreate arm odd tip sailor/thorax\n" + ticks(1, 1) +
                                       "@1 reach lonely nothing\n@2 reach nobody sailor\n@3 reach\nquit\n")
                               .out;
  EXPECT_EQ(last(said, "lonely.status"), "incomplete");
  EXPECT_EQ(last(said, "lonely.reason"), "\"tip names no node\"");
  EXPECT_EQ(last(said, "odd.reason"), "\"no joint between the world and sailor/thorax\"");
  EXPECT_NE(said.find("@1 error unknown"), std::string::npos);
  EXPECT_NE(said.find("@2 error unknown"), std::string::npos);
  EXPECT_NE(said.find("@3 error syntax"), std::string::npos);
  EXPECT_NE(said.find("\ndone 1\n"), std::string::npos);
}

TEST_F(Conversation, AVanishedTargetIsToldAndALimbThatChangesIsLookedUpAgain) {
  const std::string said =
      run("", world() + arm() + "create sphere ball position -0.3 1.3 0.3\nset sailor/right_arm.target ball\n" +
                  ticks(1, 90) + "set sailor/right_arm.target -\ndelete ball\n" + ticks(91, 2) +
                  "create sphere cup position -0.3 1.2 0.35\nset sailor/right_el_x.upper 2\n@1 reach sailor/right_arm "
                  "cup\n" +
                  ticks(93, 120) + "set sailor/right_arm.tip -\n" + ticks(213, 1) + "quit\n")
          .out;
  EXPECT_EQ(said.find("refused"), std::string::npos);
  EXPECT_NE(said.find("set sailor/right_arm.status idle\n"), std::string::npos);
  EXPECT_EQ(last(said, "sailor/right_arm.status"), "incomplete");
  const std::string after = said.substr(said.find("@1 ok"));
  EXPECT_NE(after.find("set sailor/right_arm.status reached\n"), std::string::npos);
}

// kill it anywhere: told its checkpoint and the same lines again it says the same
TEST_F(Conversation, GoesOnFromItsCheckpoint) {
  const std::string start =
      world() + arm() + "create sphere ball position -0.3 1.3 0.3\n@7 reach sailor/right_arm ball\n";
  const std::string whole = run("", start + ticks(1, 20) + "checkpoint\n" + ticks(21, 30) + "quit\n").out;
  const std::size_t cut = whole.rfind("\ndone\n");
  ASSERT_NE(cut, std::string::npos);
  // the world as it stood at the checkpoint: what the program had said is told to it
  std::string told = world() + arm() + "create sphere ball position -0.3 1.3 0.3\n";
  for (const std::string& line : lines_of(whole.substr(0, cut))) {
    if (line.starts_with("set ")) told += line + "\n";
  }
  const auto later = [](const std::string& said) {
    std::string out;
    for (const std::string& line : lines_of(said)) {
      if (line.find(".elapsed ") == std::string::npos) out += line + "\n";
    }
    return out;
  };
  const std::string again = run("", told + ticks(21, 30) + "quit\n").out;
  EXPECT_EQ(later(again.substr(again.find("\nready\n") + 7)), later(whole.substr(cut + 6)));
}

TEST_F(Conversation, SegmentsAreWeighed) {
  const std::string said =
      run("", world() + "create segment bone kind thigh body_mass 80 from 0 0 0 to 0 -0.4 0\n" + ticks(1, 2) + "quit\n")
          .out;
  EXPECT_EQ(last(said, "bone.mass"), "11.328");
  EXPECT_TRUE(last(said, "bone.center").starts_with("0 -0.1638"));
}

}  // namespace
