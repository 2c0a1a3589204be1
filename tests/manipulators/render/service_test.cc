#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/render/picture.h"

namespace render {
namespace {

std::string scratch(const std::string& name) { return testing::TempDir() + "sailor_service_" + name; }

struct Talk {
  int status = -1;
  std::string out;
};

// the program as the dialog manager talks to it: lines in, lines out
Talk talk(const std::string& lines, const std::string& environment = "") {
  const std::string input = scratch("in");
  const std::string output = scratch("out");
  std::ofstream(input) << "hello protocol=1 name=render seed=0 tick=0.1\n" << lines;
  Talk run;
  run.status =
      std::system((environment + " " + BIN_DIR + "/render < " + input + " > " + output + " 2>/dev/null").c_str());
  std::ostringstream all;
  all << std::ifstream(output).rdbuf();
  run.out = all.str();
  return run;
}

bool says(const Talk& run, const std::string& text) { return run.out.find(text) != std::string::npos; }

TEST(Service, DeclaresItselfAndLeavesWhenTold) {
  const Talk run = talk("quit\n");
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(says(run, "type view"));
  EXPECT_TRUE(says(run, "verb snapshot"));
  EXPECT_TRUE(says(run, "\nready\n"));
}

TEST(Service, TakesASnapshotOfTheWorldItWasTold) {
  const std::string file = scratch("a.png");
  std::filesystem::remove(file);
  const Talk run = talk(
      "create sphere ball position 0 0 3 radius 1 color 1 0 0\ncreate camera c\ncreate view v camera c\n"
      "@1 snapshot " +
      file + " size 64x48\n@2 snapshot " + file + " size 0x48\n@3 snapshot /nowhere/a.png\n@4 snapshot\nquit\n");
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(says(run, "@1 ok"));
  EXPECT_TRUE(says(run, "@2 error range "));
  EXPECT_TRUE(says(run, "@3 error io "));
  EXPECT_TRUE(says(run, "@4 error syntax "));
  EXPECT_TRUE(says(run, "set v.drawn 1"));
  Picture picture;
  ASSERT_EQ(read_png(file, picture), "");
  const Rgba middle = picture.at(32, 24);
  EXPECT_GT(middle[0], middle[1] + 80);
}

TEST(Service, AnswersEveryTickWhileItFilms) {
  const std::string folder = scratch("frames");
  std::filesystem::remove_all(folder);
  std::string lines =
      "create sphere ball position 0 0 3\ncreate camera c\ncreate view v camera c width 32 height 24\n"
      "@1 movie " +
      folder + " rate 5\n";
  for (int k = 1; k <= 10; ++k) {
    lines += "set ball.position 0 " + std::to_string(0.1 * k) + " 3\ntick " + std::to_string(k) + " " +
             std::to_string(0.1 * k) + " 0.1\n";
  }
  const Talk run = talk(lines + "@2 movie off\n@3 movie off\nquit\n");
  EXPECT_TRUE(says(run, "done 10"));
  EXPECT_TRUE(says(run, "5 frames, 1.000 s"));
  EXPECT_TRUE(says(run, "@2 ok"));
  EXPECT_TRUE(says(run, "@3 error unknown "));
  EXPECT_TRUE(std::filesystem::exists(folder + "/frame_000004.png"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/frame_000005.png"));
  std::filesystem::remove_all(folder);
}

TEST(Service, GoesOnWithoutADisplay) {
  const Talk run = talk(
      "create view v\n@1 window on\n@2 window refresh\n@3 bind Key-space pause\n@4 bind Nonsense pause\n"
      "@5 unbind Key-space\n@6 unbind Key-space\ntick 1 0.1 0.1\nquit\n",
      "DISPLAY=");
  EXPECT_EQ(run.status, 0);
  EXPECT_TRUE(says(run, "@1 error io "));
  EXPECT_TRUE(says(run, "@2 error unknown "));
  EXPECT_TRUE(says(run, "@3 ok"));
  EXPECT_TRUE(says(run, "@4 error range "));
  EXPECT_TRUE(says(run, "@5 ok"));
  EXPECT_TRUE(says(run, "@6 error unknown "));
  EXPECT_TRUE(says(run, "done 1"));
}

TEST(Service, TellsHowFarAMarkHasGone) {
  const Talk run = talk(
      "type face extends node\nfield face.skin ref:node\nfield face.vertices int[]\nfield face.displacement vec3[] m\n"
      "create mesh m\ncreate face f skin m vertices 3 7 displacement 0 0 1 0.3 0 0.4\ncreate mark a surface m vertex "
      "7\n"
      "create mark b surface m vertex 5\ntick 1 0.1 0.1\nset f.displacement 0 0 0 0 0 2\ntick 2 0.2 0.1\nquit\n");
  EXPECT_TRUE(says(run, "set a.travel 0.5\n"));
  EXPECT_TRUE(says(run, "set a.travel 2\n"));
  EXPECT_FALSE(says(run, "set b.travel"));
}

TEST(Service, ReportsAMeshThatIsNotThere) {
  const Talk run = talk("create mesh m file nowhere.obj\ncreate view v width 16 height 16\n@1 snapshot " +
                        scratch("m.png") + "\nquit\n");
  EXPECT_TRUE(says(run, "@1 ok"));
  EXPECT_TRUE(says(run, "set m.status failed"));
  EXPECT_TRUE(says(run, "set v.status empty"));
}

TEST(Program, UsageErrorsEndWithTwoAndBadDataWithOne) {
  auto status = [](const std::string& words) {
    return WEXITSTATUS(std::system((std::string(BIN_DIR) + "/render " + words + " >/dev/null 2>&1").c_str()));
  };
  EXPECT_EQ(status("--help"), 0);
  EXPECT_EQ(status("--nonsense"), 2);
  EXPECT_EQ(status("--draw /nowhere.dlg"), 1);
  const std::string world = scratch("w.dlg");
  std::ofstream(world) << "create sphere ball\n";
  EXPECT_EQ(status("--draw " + world + " --out " + scratch("w.png") + " --size 32x24"), 0);
  EXPECT_EQ(status("--draw " + world + " --out " + scratch("w.png") + " --size huge"), 2);
  EXPECT_EQ(status("--draw " + world + " --out /nowhere/w.png"), 1);
}

}  // namespace
}  // namespace render
