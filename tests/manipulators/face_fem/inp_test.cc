#include "manipulators/face_fem/inp_file.h"

#include <gtest/gtest.h>

#include "manipulators/face_fem/vtu_file.h"
#include "tests/manipulators/face_fem/bodies.h"

namespace face {
namespace {

const std::string cube = R"(*HEADING
a cube
** a remark
*Node, nset=All
10, 0, 0, 0
20, 1., 0, 0
30, 1, 1, 0.
40, 0, 1, 0
50, 0, 0, 1
60, 1, 0, 1
70, 1, 1, 1e0
80, 0, 1, 1.D0
*Element, type=C3D8, elset=Eall
7, 10, 20, 30, 40,
   50, 60, 70, 80
*Nset, nset=Base, generate
10, 40, 10
*Material, name=Rubber
*Elastic
1e6, 0.3
*Density
1000
*Solid Section, elset=EALL, material=RUBBER

*Step
*Static
*Boundary
Base, 1, 3
80, 3, 3, 0.01
*Cload
60, 3, 2.5
*Dload
Eall, P2, 100
7, GRAV, 9.81, 0, 0, -2
*Node Print, nset=All
U
*End Step
)";

/// the text with one part replaced
std::string with(const std::string& from, const std::string& to) {
  std::string text = cube;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Inp, ReadsNodesElementsSetsMaterialsSupportsAndLoads) {
  const auto job = parse_inp(cube, "cube.inp");
  ASSERT_TRUE(job) << job.error().sentence;
  const Model& model = job->model;
  ASSERT_EQ(model.nodes.size(), 8u);
  EXPECT_EQ(model.nodes[7], Eigen::Vector3d(0, 1, 1));
  EXPECT_EQ(model.label_of_node(5), 60);
  ASSERT_EQ(model.hexahedra.size(), 1u);
  EXPECT_EQ(model.label_of_hexahedron(0), 7);
  EXPECT_EQ(model.hexahedra[0].node[6], 6);
  EXPECT_EQ(model.element, Element::bbar);
  EXPECT_EQ(model.materials[0].young, 1e6);
  EXPECT_EQ(model.materials[0].density, 1000);
  EXPECT_EQ(job->node_sets.at("BASE"), (std::vector<int>{0, 1, 2, 3}));
  ASSERT_EQ(model.supports.size(), 5u);
  EXPECT_EQ(model.supports[4].node, 7);
  EXPECT_EQ(model.supports[4].held, (std::array<bool, 3>{false, false, true}));
  EXPECT_EQ(model.supports[4].shift.z(), 0.01);
  // pressure on the upper side pushes down, a quarter to each corner; so does an eighth of the weight
  const double weight = 1000 * 9.81 / 8;
  EXPECT_NEAR(job->load(2, 4), -25 - weight, 1e-9);
  EXPECT_NEAR(job->load(2, 5), -25 - weight + 2.5, 1e-9);
  EXPECT_NEAR(job->load(2, 0), -weight, 1e-9);
  EXPECT_NEAR(job->load(0, 6), 0, 1e-12);
  EXPECT_TRUE(job->has_step);
}

TEST(Inp, NamesPlaceThingExpectationAndValue) {
  struct Bad {
    std::string text;
    Fault fault;
    std::string place;
  };
  const Bad cases[] = {
      {with("1, 1, 1e0", "1, 1, one"), Fault::syntax, "cube.inp:11:11"},
      {with("0.01", "nan"), Fault::not_finite, "cube.inp:29:11"},
      {with("1, 1, 1e0", "1, 1, 1e999"), Fault::not_finite, "cube.inp:11:11"},
      {with("50, 60, 70, 80\n*", "50, 60, 70, 81\n*"), Fault::unknown, "cube.inp:15:16"},
      {with("70, 80\n*", "70\n*"), Fault::element, "cube.inp:16:"},
      {with("70, 80\n*", "70, 80, 10\n*"), Fault::element, "cube.inp:15:"},
      {with("1e6, 0.3", "1e6, 0.5"), Fault::material, "cube.inp:20:6"},
      {with("1e6, 0.3", "-1, 0.3"), Fault::material, "cube.inp:20:1"},
      {with("type=C3D8", "type=C3D10"), Fault::unknown, "cube.inp:13:"},
      {with("material=RUBBER", "material=steel"), Fault::unknown, "cube.inp:23:"},
      {with("elset=EALL", "elset=others"), Fault::unknown, "cube.inp:23:"},
      {with("Base, 1, 3", "Bose, 1, 3"), Fault::unknown, "cube.inp:28:1"},
      {with("Base, 1, 3", "Base, 1, 4"), Fault::load, "cube.inp:28:10"},
      {with("P2, 100", "P7, 100"), Fault::unknown, "cube.inp:33:7"},
      {with("0, 0, -2", "0, 0, 0"), Fault::load, "cube.inp:34:"},
      {with("*Cload", "*Contact"), Fault::unknown, "cube.inp:30:2"},
      {with("20, 1., 0, 0", "10, 1., 0, 0"), Fault::syntax, "cube.inp:6:1"},
      {with("*Static", "*Static\n*Step"), Fault::syntax, "cube.inp:27:1"},
      {with("*Step", "*Step, nlgeom"), Fault::unknown, "cube.inp:25:"},
      {with("*Elastic\n1e6, 0.3\n", ""), Fault::material, "cube.inp:"},
      {"1, 2, 3\n", Fault::syntax, "cube.inp:1:1"},
      {"", Fault::truncated, "cube.inp"},
  };
  for (const Bad& bad : cases) {
    const auto job = parse_inp(bad.text, "cube.inp");
    ASSERT_FALSE(job) << bad.place;
    EXPECT_EQ(job.error().fault, bad.fault) << job.error().sentence;
    EXPECT_EQ(job.error().sentence.rfind(bad.place, 0), 0u) << job.error().sentence << " is not at " << bad.place;
  }
}

TEST(Inp, ACutFileIsAnErrorOrHasNoStepWhereverItIsCut) {
  for (std::size_t length = 0; length + 2 < cube.size(); ++length) {
    const auto job = parse_inp(cube.substr(0, length), "cut.inp");
    if (job) {
      EXPECT_FALSE(job->has_step) << "cut at " << length << ": " << cube.substr(0, length);
    }
  }
}

TEST(Inp, SurvivesAnyChangedByte) {
  for (std::size_t at = 0; at < cube.size(); ++at)
    for (char c : {'\0', ',', '*', '-', '9', '\n'}) {
      std::string text = cube;
      text[at] = c;
      const auto job = parse_inp(text, "odd.inp");
      if (job) {
        EXPECT_TRUE(job->load.allFinite());
      }
    }
}

TEST(Inp, MixedElementsAreRefused) {
  const auto job =
      parse_inp(cube.substr(0, cube.find("*Nset, nset=Base")) + "*Element, type=C3D8I\n8, 10, 20\n", "mix.inp");
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().fault, Fault::element);
}

TEST(Inp, WhatIsWrittenReadsBackToTwelveDigits) {
  for (Element element : {Element::bbar, Element::wt, Element::hex20, Element::hex20r}) {
    Model model = cap(element, 3, 2, 3);
    model.supports[0].shift = {1e-4, -2e-5, 0};
    Field load = Field::Zero(3, int(model.nodes.size()));
    for (const Side& side : model.skin) add_pressure(model, side, 123.4, load);
    const std::string path = testing::TempDir() + "face_fem_written.inp";
    ASSERT_TRUE(write_inp(path, model, load));
    const auto job = read_inp(path);
    ASSERT_TRUE(job) << job.error().sentence;
    EXPECT_EQ(job->model.element, element);
    ASSERT_EQ(job->model.nodes.size(), model.nodes.size());
    for (std::size_t n = 0; n < model.nodes.size(); ++n)
      EXPECT_LE((job->model.nodes[n] - model.nodes[n]).norm(), 1e-12);
    // elements are written material by material; sets tell them apart
    EXPECT_EQ(job->element_sets.at("LAYER_FAT").size(), 6u);
    EXPECT_EQ(job->node_sets.at("BONE_SKULL").size(), model.supports.size());
    EXPECT_LE((job->load - load).norm(), 1e-11 * load.norm());
    const auto ours = Statics::make(model), theirs = Statics::make(job->model);
    ASSERT_TRUE(ours && theirs);
    const Field u = ours->solve(load).u, v = theirs->solve(job->load).u;
    EXPECT_LE((u - v).norm(), 1e-9 * u.norm());
  }
}

TEST(Inp, MissingFilesAreNamed) {
  const auto job = read_inp("/nowhere/face.inp");
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().fault, Fault::io);
  EXPECT_NE(job.error().sentence.find("/nowhere/face.inp"), std::string::npos);
  const Model model = cap(Element::bbar, 3, 2, 3);
  const auto written = write_inp("/nowhere/face.inp", model, Field::Zero(3, int(model.nodes.size())));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, Fault::io);
}

TEST(Vtu, HoldsPointsCellsAndData) {
  const Model model = cap(Element::hex20, 2, 2, 3);
  const std::string path = testing::TempDir() + "face_fem.vtu";
  ASSERT_TRUE(write_vtu(path, model, Field::Ones(3, int(model.nodes.size()))));
  std::FILE* file = std::fopen(path.c_str(), "r");
  std::string text(1 << 20, ' ');
  text.resize(std::fread(text.data(), 1, text.size(), file));
  std::fclose(file);
  EXPECT_NE(text.find("NumberOfPoints=\"" + std::to_string(model.nodes.size()) + "\" NumberOfCells=\"12\""),
            std::string::npos);
  EXPECT_NE(text.find("Name=\"displacement\" NumberOfComponents=\"3\""), std::string::npos);
  EXPECT_NE(text.find("</VTKFile>"), std::string::npos);
}

}  // namespace
}  // namespace face
