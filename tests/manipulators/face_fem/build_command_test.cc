// Runs `face_fem --build`, and CalculiX on what it writes where that is installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/manipulators/face_fem/heads.h"
#include "tests/manipulators/face_fem/program.h"

namespace face {
namespace {

using program::Finished;
using program::run;

class BuildCommand : public program::InFolder {
 protected:
  void SetUp() override {
    if (!std::ifstream(sailor())) GTEST_SKIP() << "human.zae of assimp-testmodels is not installed";
    InFolder::SetUp();
  }
  static std::string sailor() { return "/usr/share/assimp/models/Collada/human.zae"; }
  Finished build(const std::string& words) const { return run(program() + " --build " + words); }
};

TEST_F(BuildCommand, WritesTheFaceInEveryForm) {
  const Finished done =
      build(sailor() + " --resolution 16 --muscle zygomaticus_major=0.3 --scan " + in("scan.csv") + " --write " +
            in("face.inp") + " --vtu " + in("face.vtu") + " --surface " + in("head.obj"));
  EXPECT_EQ(done.status, 0) << done.text;
  EXPECT_NE(done.text.find("muscles    39"), std::string::npos) << done.text;
  for (const char* file : {"scan.csv", "face.inp", "face.vtu", "head.obj"})
    EXPECT_GT(std::filesystem::file_size(in(file)), 10000U) << file;
  std::ifstream scan(in("scan.csv"));
  std::string header;
  std::getline(scan, header);
  EXPECT_EQ(header, "angle_deg,height_m,radius_m,x_m,y_m,z_m");
  // the head moved, but only where the face is
  const auto before = mesh::read_surface(sailor()), after = mesh::read_surface(in("head.obj"));
  ASSERT_TRUE(after);
  EXPECT_EQ(before->V.rows(), after->V.rows());
}

TEST_F(BuildCommand, ListsLandmarksAndMuscles) {
  const Finished done = build(sailor() + " --list");
  EXPECT_EQ(done.status, 0);
  EXPECT_NE(done.text.find("landmark nose_tip"), std::string::npos);
  EXPECT_NE(done.text.find("muscle left_zygomaticus_major"), std::string::npos);
}

TEST_F(BuildCommand, RefusesInOneLine) {
  const auto refused = [&](const std::string& words, const std::string& sentence) {
    const Finished done = build(words);
    EXPECT_EQ(done.status, 1) << done.text;
    EXPECT_NE(done.text.find("face_fem: error " + sentence), std::string::npos) << done.text;
    EXPECT_EQ(std::count(done.text.begin(), done.text.end(), '\n'), 1) << done.text;
  };
  refused("nobody.obj", "io mesh file nobody.obj does not exist");
  refused(sailor() + " --unit 0.01", "mesh a head");
  refused(sailor() + " --unit 0", "limit --unit");
  refused(sailor() + " --resolution 15", "limit columns");
  refused(sailor() + " --resolution 3x", "syntax --resolution");
  refused(sailor() + " --muscle biceps=1", "unknown no muscle is called 'biceps'");
  refused(sailor() + " --muscle procerus=much", "syntax --muscle");
  refused(sailor() + " --landmark tail=0,0,0", "unknown no landmark is called 'tail'");
  refused(sailor() + " --landmark chin=0,0", "syntax --landmark");
  EXPECT_EQ(run(program() + " --muscle procerus=1").status, 2);
}

TEST_F(BuildCommand, CalculixMovesTheFaceAsWeDo) {
  if (!program::has_calculix()) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  // our hex8 is CalculiX's C3D8; it prints seven digits
  const Finished done =
      build(sailor() + " --resolution 24 --muscle left_zygomaticus_major=0.5 --write " + in("face.inp"));
  ASSERT_EQ(done.status, 0) << done.text;
  ASSERT_EQ(run(program() + " --solve " + in("face.inp") + " --element hex8 --out " + in("u.csv")).status, 0);
  const Finished theirs = run("cd " + in(".") + " && OMP_NUM_THREADS=1 ccx face");
  ASSERT_EQ(theirs.status, 0) << theirs.text;
  const auto u = program::displacements(in("u.csv")), v = program::printed(in("face.dat"));
  EXPECT_EQ(u.size(), v.size());
  EXPECT_LE(program::difference(u, v), 1e-6);
}

}  // namespace
}  // namespace face
