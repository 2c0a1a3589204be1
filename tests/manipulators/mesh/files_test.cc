#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "manipulators/mesh/find.h"
#include "manipulators/mesh/read.h"
#include "manipulators/mesh/topology.h"
#include "manipulators/mesh/write.h"
#include "tests/manipulators/mesh/surfaces.h"

namespace {

/// A folder of its own, gone afterwards.
class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "mesh_XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
    return file(name);
  }
  std::string fault(const std::string& path) const {
    const auto read = mesh::read_surface(path);
    return read ? "no error" : read.error().kind + " " + read.error().sentence;
  }
  std::filesystem::path folder;
};

TEST_F(Files, EveryFormatComesBackAsItWent) {
  mesh::Surface surface = known::sphere(0.25, 10, 14);
  for (const char* name : {"ball.obj", "ball.ply", "ball.stl", "ball.glb"}) {
    const auto written = mesh::write_surface(file(name), surface);
    ASSERT_TRUE(written) << written.error().sentence;
    const auto read = mesh::read_surface(file(name));
    ASSERT_TRUE(read) << read.error().sentence;
    EXPECT_EQ(read->V.rows(), surface.V.rows()) << name;
    EXPECT_EQ(read->F.rows(), surface.F.rows()) << name;
    const mesh::Topology before = mesh::topology(surface), after = mesh::topology(*read);
    EXPECT_TRUE(after.closed()) << name;
    EXPECT_EQ(after.euler, 2) << name;
    // all formats keep single precision: volume to its rounding, 1e-7 per coordinate
    EXPECT_NEAR(after.volume, before.volume, 1e-6 * before.volume) << name;
  }
}

TEST_F(Files, PartsSurviveWhereTheFormatHasThem) {
  mesh::Surface surface = known::cube();
  surface.part_names = {"front", "rest"};
  surface.part.assign(12, 1);
  surface.part[2] = surface.part[3] = 0;
  for (const char* name : {"cube.obj", "cube.glb"}) {
    ASSERT_TRUE(mesh::write_surface(file(name), surface));
    const auto read = mesh::read_surface(file(name));
    ASSERT_TRUE(read) << read.error().sentence;
    EXPECT_EQ(read->part_names, surface.part_names) << name;
    EXPECT_EQ(std::count(read->part.begin(), read->part.end(), 0), 2) << name;
  }
}

TEST_F(Files, UnitsAndUpAxisOfColladaBecomeMetresAndY) {
  // one triangle of 100 x 200 in centimetres with Z up: 1 m wide, 2 m high
  const std::string path = write("sheet.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="centimeter"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="sheet"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 0 200</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  const auto read = mesh::read_surface(path);
  ASSERT_TRUE(read) << read.error().sentence;
  const mesh::Bounds box = mesh::bounds(*read);
  EXPECT_NEAR(box.upper.x() - box.lower.x(), 1, 1e-6);
  EXPECT_NEAR(box.upper.y() - box.lower.y(), 2, 1e-6);
  EXPECT_NEAR(box.upper.z() - box.lower.z(), 0, 1e-6);
}

TEST_F(Files, BadFilesHaveOneClearError) {
  EXPECT_EQ(fault(file("none.obj")), "io mesh file " + file("none.obj") + " does not exist");
  EXPECT_EQ(fault(folder.string()), "io mesh file " + folder.string() + " is not a file");
  EXPECT_EQ(fault(write("words.txt", "hello")).substr(0, 6), "syntax");
  EXPECT_EQ(fault(write("empty.obj", "")).substr(0, 6), "syntax");
  EXPECT_EQ(fault(write("broken.dae", "<COLLADA><asset>")).substr(0, 6), "syntax");
  EXPECT_EQ(fault(write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n")).substr(0, 6), "syntax");
  EXPECT_NE(fault(write("short.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                        "end_header\n0 0 0\n")),
            "no error");
  EXPECT_NE(fault(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), "no error");
  EXPECT_EQ(fault(write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")).substr(0, 5), "range");
  EXPECT_EQ(fault(write("huge.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n")).substr(0, 5), "range");
  EXPECT_EQ(fault(write("thin.obj", "v 0 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n")).substr(0, 5), "range");
  EXPECT_NE(fault(write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n")), "no error");
}

TEST_F(Files, WriteRefusesWhatItCannotKeep) {
  const auto fault_of = [](const mesh::Result<std::size_t>& result) {
    return result ? "no error" : result.error().kind;
  };
  mesh::Surface cube = known::cube();
  EXPECT_EQ(fault_of(mesh::write_surface(file("cube.xyz"), cube)), "unknown");
  EXPECT_EQ(fault_of(mesh::write_surface(file("no/such/cube.obj"), cube)), "io");
  cube.V(0, 0) = std::nanf("");
  EXPECT_EQ(fault_of(mesh::write_surface(file("cube.obj"), cube)), "range");
  cube = known::cube();
  cube.F(0, 0) = 8;
  EXPECT_EQ(fault_of(mesh::write_surface(file("cube.obj"), cube)), "range");
  EXPECT_EQ(fault_of(mesh::write_surface(file("cube.obj"), mesh::Surface())), "range");
}

TEST_F(Files, AreFoundWhereTheyAreSaidToBe) {
  const std::string path = write("here.obj", "");
  EXPECT_EQ(*mesh::find_file(path), path);
  setenv("SAILOR_SCENES", ("/no/such:" + folder.string()).c_str(), 1);
  EXPECT_EQ(*mesh::find_file("here.obj"), path);
  const auto missing = mesh::find_file("nowhere.obj");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, "io");
  EXPECT_NE(missing.error().sentence.find(folder.string()), std::string::npos);
  unsetenv("SAILOR_SCENES");
  // the figure's own meshes lie among the installed scripts
  EXPECT_TRUE(mesh::find_file("cap.obj"));
}

}  // namespace
