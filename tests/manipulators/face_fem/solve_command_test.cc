// Runs the program itself, and CalculiX beside it where that is installed.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "manipulators/face_fem/inp_file.h"
#include "tests/manipulators/face_fem/bodies.h"
#include "tests/manipulators/face_fem/program.h"

namespace face {
namespace {

namespace fs = std::filesystem;

using program::displacements;
using program::Finished;
using program::run;

class SolveCommand : public program::InFolder {};

TEST_F(SolveCommand, SolvesWritesAndSumsUp) {
  bodies::Case beam = bodies::twisted_beam(Element::wt, 12, 2, 2, {0, 0, 1});
  ASSERT_TRUE(write_inp(in("beam.inp"), beam.model, beam.load));
  const Finished done = run(program() + " --solve " + in("beam.inp") + " --element wt --stress --out " + in("u.csv") +
                            " --vtu " + in("u.vtu"));
  EXPECT_EQ(done.status, 0) << done.text;
  EXPECT_EQ(done.text.rfind("status     ok", 0), 0u) << done.text;
  const auto u = displacements(in("u.csv"));
  EXPECT_EQ(u.size(), beam.model.nodes.size());
  const Field exact = Statics::make(beam.model)->solve(beam.load).u;
  for (const auto& [node, v] : u) EXPECT_LE((v - exact.col(node - 1)).norm(), 1e-9);
  std::ifstream file(in("u.csv"));
  std::string header;
  std::getline(file, header);
  EXPECT_EQ(header, "node,ux_m,uy_m,uz_m,sxx,syy,szz,sxy,syz,szx");
  EXPECT_TRUE(fs::exists(in("u.vtu")));
  // the table alone on standard output
  const Finished piped = run(program() + " --solve " + in("beam.inp") + " 2>/dev/null");
  EXPECT_EQ(piped.text.rfind("node,ux_m,uy_m,uz_m\n1,", 0), 0u);
}

TEST_F(SolveCommand, TellsWhatIsWrongInOneLineAndByItsExitStatus) {
  const Finished usage = run(program() + " --solv x");
  EXPECT_EQ(usage.status, 2) << usage.text;
  EXPECT_EQ(run(program() + " --element hex9 --solve x").status, 2);
  const Finished missing = run(program() + " --solve " + in("none.inp"));
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.text.find("error io " + in("none.inp")), std::string::npos) << missing.text;
  Model model = cap(Element::bbar, 2, 2, 3);
  const Field none = Field::Zero(3, int(model.nodes.size()));
  model.supports.resize(2);
  ASSERT_TRUE(write_inp(in("loose.inp"), model, none));
  const Finished loose = run(program() + " --solve " + in("loose.inp"));
  EXPECT_EQ(loose.status, 1);
  EXPECT_NE(loose.text.find("error unsupported"), std::string::npos) << loose.text;
  EXPECT_EQ(std::count(loose.text.begin(), loose.text.end(), '\n'), 1) << loose.text;
  const Finished wrong = run(program() + " --element hex20 --solve " + in("loose.inp"));
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.text.find("error element"), std::string::npos) << wrong.text;
}

TEST_F(SolveCommand, WarnsOfLargeStrainAndSolvesItNonlinearly) {
  Model model = cap(Element::bbar, 4, 4, 3);
  Field load = Field::Zero(3, int(model.nodes.size()));
  for (const Side& side : model.skin) add_pressure(model, side, 30000, load);
  ASSERT_TRUE(write_inp(in("hard.inp"), model, load));
  const Finished linear = run(program() + " --solve " + in("hard.inp") + " --out " + in("linear.csv"));
  EXPECT_EQ(linear.status, 0);
  EXPECT_NE(linear.text.find("warning"), std::string::npos) << linear.text;
  const Finished large = run(program() + " --nonlinear --solve " + in("hard.inp") + " --out " + in("large.csv"));
  EXPECT_EQ(large.status, 0) << large.text;
  EXPECT_NE(large.text.find("converged"), std::string::npos) << large.text;
  const auto u = displacements(in("linear.csv")), v = displacements(in("large.csv"));
  double apart = 0, size = 0;
  for (const auto& [node, value] : u) apart += (value - v.at(node)).squaredNorm(), size += value.squaredNorm();
  EXPECT_GT(apart, 0.0025 * size);
}

class AgainstCalculix : public SolveCommand {
 protected:
  /// relative difference of our answer and CalculiX's on the same file
  double difference(const bodies::Case& body, Element element) {
    EXPECT_TRUE(write_inp(in("job.inp"), body.model, body.load));
    const Finished ours = run(program() + " --solve " + in("job.inp") + " --element " + std::string(name_of(element)) +
                              " --out " + in("u.csv"));
    EXPECT_EQ(ours.status, 0) << ours.text;
    const Finished theirs = run("cd " + folder_.string() + " && OMP_NUM_THREADS=1 ccx job");
    EXPECT_EQ(theirs.status, 0) << theirs.text;
    const auto u = displacements(in("u.csv")), v = program::printed(in("job.dat"));
    EXPECT_EQ(u.size(), v.size());
    return program::difference(u, v);
  }
};

TEST_F(AgainstCalculix, TheElementsAreTheSameToThePrintedDigits) {
  if (!program::has_calculix()) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  // CalculiX prints seven digits
  constexpr double printed = 1e-6;
  EXPECT_LE(difference(bodies::twisted_beam(Element::hex8, 12, 2, 2, {0, 0, 1}), Element::hex8), printed);
  EXPECT_LE(difference(bodies::twisted_beam(Element::wt, 12, 2, 2, {0, 1, 0}), Element::wt), printed);
  EXPECT_LE(difference(bodies::twisted_beam(Element::hex20, 12, 2, 2, {0, 1, 0}), Element::hex20), printed);
  EXPECT_LE(difference(bodies::curved_beam(Element::hex8, 12, 2, 2, {0, 0, 1}), Element::hex8), printed);
  EXPECT_LE(difference(bodies::curved_beam(Element::hex20r, 12, 2, 2, {0, 1, 0}), Element::hex20r), printed);
  EXPECT_LE(difference(bodies::le10(Element::hex8, 4, 6, 2), Element::hex8), printed);
  EXPECT_LE(difference(bodies::le10(Element::hex20, 4, 6, 2), Element::hex20), printed);
  EXPECT_LE(difference(bodies::le10(Element::hex20r, 4, 6, 2), Element::hex20r), printed);
  bodies::Case layered{cap(Element::hex8, 8, 8, 3), {}};
  layered.load = Field::Zero(3, int(layered.model.nodes.size()));
  for (const Side& side : layered.model.skin) add_pressure(layered.model, side, 100, layered.load);
  EXPECT_LE(difference(layered, Element::hex8), printed);
}

}  // namespace
}  // namespace face
