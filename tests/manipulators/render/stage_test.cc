#include "manipulators/render/stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "manipulators/render/declaration.h"
#include "manipulators/render/elements.h"
#include "manipulators/render/look.h"
#include "manipulators/render/studio.h"
#include "manipulators/render/world_file.h"

namespace render {
namespace {

// a world from lines of the language
class World : public objdb::Database {
 public:
  explicit World(const std::string& lines) {
    EXPECT_EQ(declare_types(declaration, *this), "");
    const std::string file = testing::TempDir() + "sailor_stage_world.dlg";
    std::ofstream(file) << lines;
    problem = read_world(file, *this);
  }
  std::string problem;
};

const Drawable* drawable(const Scene& scene, const std::string& path) {
  for (const Drawable& one : scene.drawables) {
    if (one.path == path && !one.helper) return &one;
  }
  return nullptr;
}

int helpers(const Scene& scene) {
  int count = 0;
  for (const Drawable& one : scene.drawables) count += one.helper;
  return count;
}

TEST(Stage, ShapesStandWhereTheTreeOfFramesPutsThem) {
  World world(R"(create node table position 1 0.5 0 orientation 0.7071067811865476 0 0.7071067811865476 0
create box table/crate position 0 0.25 1 size 0.2 0.4 0.6 color 0.1 0.2 0.3
create sphere ball radius 0.3 scale 1 2 1
create cylinder post radius 0.1 length 2
create capsule rod radius 0.1 length 1
)");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene scene = stage.compose(world, nullptr, 0);
  ASSERT_EQ(scene.drawables.size(), 4u);
  // a quarter turn about Y takes the table's +Z to the world's +X, so the crate's sides swap
  const Eigen::AlignedBox3f crate = world_bounds(*drawable(scene, "table/crate"));
  EXPECT_TRUE(crate.center().isApprox(Eigen::Vector3f(2, 0.75f, 0), 1e-5f));
  EXPECT_TRUE(crate.sizes().isApprox(Eigen::Vector3f(0.6f, 0.4f, 0.2f), 1e-5f));
  EXPECT_TRUE(drawable(scene, "table/crate")->materials[0].color.isApprox(Eigen::Vector3f(0.1f, 0.2f, 0.3f)));
  EXPECT_NEAR(world_bounds(*drawable(scene, "ball")).sizes().y(), 1.2f, 1e-5f);
  EXPECT_NEAR(world_bounds(*drawable(scene, "post")).sizes().y(), 2, 1e-5f);
  EXPECT_NEAR(world_bounds(*drawable(scene, "rod")).sizes().y(), 1.2f, 1e-5f);
}

TEST(Stage, InvisibleThingsHideWhatIsBelowThem) {
  World world(
      "create node box\ncreate sphere box/a\ncreate sphere b parent box\ncreate sphere c\nset box.visible false\n");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene scene = stage.compose(world, nullptr, 0);
  ASSERT_EQ(scene.drawables.size(), 1u);
  EXPECT_EQ(scene.drawables[0].path, "c");
}

TEST(Stage, MissingAndBrokenMeshesAreReportedAndTheRestIsDrawn) {
  const std::string broken = testing::TempDir() + "sailor_broken.obj";
  std::ofstream(broken) << "v 0 0 nan\nf 1 2 3\n";
  World world("create mesh lost file nowhere.obj\ncreate mesh broken file " + broken +
              "\ncreate skin bare\ncreate sphere ball\n");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene scene = stage.compose(world, nullptr, 0);
  EXPECT_EQ(scene.drawables.size(), 1u);
  ASSERT_EQ(stage.reports().size(), 3u);
  EXPECT_EQ(stage.reports()[0].status, "failed");
  EXPECT_NE(stage.reports()[0].reason.find("nowhere.obj"), std::string::npos);
  EXPECT_EQ(stage.reports()[1].status, "failed");
  EXPECT_NE(stage.reports()[1].reason, "");
  EXPECT_EQ(stage.reports()[2].status, "none");
}

TEST(Stage, StandInFollowsItsBone) {
  World world(R"(create node figure
create node figure/bones
create joint figure/elbow dh 0 0 0 0 lower -3 upper 3
create bone figure/bones/upper from 0 -0.3 0 to 0 0 0 radius 0.05
create bone figure/bones/lower parent figure/elbow from 0 0 0 to 0 0.3 0 radius 0.05
create skin figure/body skeleton figure/bones file not_there.obj
)");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene before = stage.compose(world, nullptr, 0);
  ASSERT_EQ(before.drawables.size(), 1u);
  EXPECT_EQ(stage.reports()[0].status, "stand_in");
  EXPECT_GT(world_bounds(before.drawables[0]).max().y(), 0.3f);
  // the elbow turns a right angle about z: the lower bone now points to -X
  const objdb::Object* elbow = world.find("figure/elbow");
  ASSERT_TRUE(world.set(*elbow, elbow->type->find("angle"), 1.5707963267948966).ok());
  const std::uint64_t generation = before.drawables[0].geometry->generation;
  const Scene after = stage.compose(world, nullptr, 0);
  EXPECT_LT(world_bounds(after.drawables[0]).min().x(), -0.3f);
  EXPECT_LT(world_bounds(after.drawables[0]).max().y(), 0.2f);
  // somebody still shows the old pose, so that one was left alone
  EXPECT_EQ(before.drawables[0].geometry->generation, generation);
  EXPECT_GT(world_bounds(before.drawables[0]).max().y(), 0.3f);
}

TEST(Stage, SurfacesCarriedByObjectsAreDrawnWithFreshNormals) {
  World world(R"(type sheet extends node
field sheet.vertices vec3[] m
field sheet.triangles int[]
create sheet s vertices 0 0 0 1 0 0 0 1 0 triangles 0 1 2
create sheet broken vertices 0 0 0 1 0 0 0 1 0 triangles 0 1 3
create sheet empty
)");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene before = stage.compose(world, nullptr, 0);
  ASSERT_EQ(before.drawables.size(), 1u);
  EXPECT_TRUE(before.drawables[0].geometry->vertices[0].normal.isApprox(Eigen::Vector3f::UnitZ()));
  const objdb::Object& sheet = *world.find("s");
  ASSERT_TRUE(world.set(sheet, sheet.type->find("vertices"), std::vector<double>{0, 0, 0, 0, 1, 0, 0, 0, 1}).ok());
  const Scene after = stage.compose(world, nullptr, 0);
  EXPECT_TRUE(after.drawables[0].geometry->vertices[0].normal.isApprox(Eigen::Vector3f::UnitX()));
}

// a square of 9 x 9 vertices in the plane z = 0, side 0.8, vertex 9 r + c at (0.1 c, 0.1 r)
std::string sheet_file() {
  const std::string file = testing::TempDir() + "sailor_stage_sheet.obj";
  std::ofstream out(file);
  for (int r = 0; r < 9; ++r) {
    for (int c = 0; c < 9; ++c) out << "v " << 0.1 * c << " " << 0.1 * r << " 0\n";
  }
  for (int r = 1; r < 9; ++r) {
    for (int c = 1; c < 9; ++c) {
      const int d = 9 * r + c + 1;
      out << "f " << d - 10 << " " << d - 9 << " " << d << " " << d - 1 << "\n";
    }
  }
  return file;
}

// the type as a program that computes faces declares it
const std::string face_type = R"(type face extends node
field face.skin ref:node
field face.vertices int[]
field face.displacement vec3[] m
)";

// the vertex of the geometry nearest to a point
const Vertex& nearest(const Geometry& geometry, const Eigen::Vector3f& p) {
  return *std::min_element(geometry.vertices.begin(), geometry.vertices.end(), [&](const Vertex& a, const Vertex& b) {
    return (a.position - p).norm() < (b.position - p).norm();
  });
}

void displace(World& world, const std::string& face, const std::vector<double>& by) {
  const objdb::Object& object = *world.find(face);
  ASSERT_TRUE(world.set(object, object.type->find("displacement"), by).ok());
}

TEST(Stage, AFaceMovesTheSkinBeforeItsBonesDo) {
  World world(face_type + R"(create node figure
create node figure/bones
create joint figure/neck dh 0 0 0 0 lower -3 upper 3
create bone figure/bones/head parent figure/neck from 0 0 0 to 0.8 0.8 0 radius 0.3
create skin figure/body skeleton figure/bones file )" +
              sheet_file() + R"(
create garment figure/lips skin figure/body lines 0.2 0.4 0 0.03 0.6 0.4 0 0.03
create face figure/face skin figure/body vertices 40
)");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene rest = stage.compose(world, nullptr, 0);
  ASSERT_EQ(rest.drawables.size(), 1u);
  EXPECT_EQ(stage.reports()[0].reason, "");
  EXPECT_NEAR(nearest(*rest.drawables[0].geometry, {0.4f, 0.4f, 0}).position.z(), 0, 1e-6);

  // the middle vertex comes forward by 5 cm; what was cut out of its faces comes along by its share
  displace(world, "figure/face", {0, 0, 0.05});
  const Scene smile = stage.compose(world, nullptr, 0);
  const Geometry& geometry = *smile.drawables[0].geometry;
  EXPECT_NEAR(nearest(geometry, {0.4f, 0.4f, 0.05f}).position.z(), 0.05, 1e-6);
  int between = 0;
  for (const Vertex& vertex : geometry.vertices) {
    const float away = (vertex.position.head<2>() - Eigen::Vector2f(0.4f, 0.4f)).cwiseAbs().maxCoeff();
    if (away >= 0.1f - 1e-4f) {
      EXPECT_NEAR(vertex.position.z(), 0, 1e-6);
    }
    between += vertex.position.z() > 0.005f && vertex.position.z() < 0.045f;
    EXPECT_NEAR(vertex.normal.norm(), 1, 1e-5);
  }
  EXPECT_GT(between, 4);
  EXPECT_LT(nearest(geometry, {0.3f, 0.4f, 0}).normal.x(), -0.05f);
  // somebody still shows the face at rest, so that one was left alone
  EXPECT_NEAR(nearest(*rest.drawables[0].geometry, {0.4f, 0.4f, 0}).position.z(), 0, 1e-6);

  // the head turns a quarter about z and takes the expression with it
  const objdb::Object* neck = world.find("figure/neck");
  ASSERT_TRUE(world.set(*neck, neck->type->find("angle"), 1.5707963267948966).ok());
  const Scene turned = stage.compose(world, nullptr, 0);
  EXPECT_NEAR(nearest(*turned.drawables[0].geometry, {-0.4f, 0.4f, 0.05f}).position.z(), 0.05, 1e-6);

  // at rest again it is the surface it was, whichever way it came there
  displace(world, "figure/face", {0, 0, 0});
  ASSERT_TRUE(world.set(*neck, neck->type->find("angle"), 0.0).ok());
  const Scene again = stage.compose(world, nullptr, 0);
  for (std::size_t v = 0; v < rest.drawables[0].geometry->vertices.size(); ++v) {
    ASSERT_EQ(again.drawables[0].geometry->vertices[v].position, rest.drawables[0].geometry->vertices[v].position);
    ASSERT_EQ(again.drawables[0].geometry->vertices[v].normal, rest.drawables[0].geometry->vertices[v].normal);
  }
}

TEST(Stage, AFaceMovesItsOwnMeshAndNoOtherOfTheSameFile) {
  const std::string file = sheet_file();
  World world(face_type + "create mesh a file " + file + "\ncreate mesh b file " + file +
              "\ncreate face f skin a vertices 40 41 displacement 0 0 0.05 0 0 0.01\n");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene scene = stage.compose(world, nullptr, 0);
  EXPECT_NEAR(world_bounds(*drawable(scene, "a")).max().z(), 0.05, 1e-6);
  EXPECT_EQ(world_bounds(*drawable(scene, "b")).max().z(), 0);
  EXPECT_NE(drawable(scene, "a")->geometry->id, drawable(scene, "b")->geometry->id);
  displace(world, "f", {0, 0, -0.02, 0, 0, 0});
  const Scene after = stage.compose(world, nullptr, 0);
  EXPECT_NEAR(world_bounds(*drawable(after, "a")).min().z(), -0.02, 1e-6);
  EXPECT_GT(drawable(after, "a")->geometry->generation, drawable(scene, "a")->geometry->generation);
}

TEST(Stage, AFaceIsSeenOnlyWhereItIs) {
  World world(face_type + R"(create node figure
create node figure/bones
create bone figure/bones/head from 0 0 0 to 0.8 0.8 0 radius 0.3
create skin figure/body skeleton figure/bones file )" +
              sheet_file() + R"(
create face figure/face skin figure/body vertices 50 80
create camera whole position 0.4 0.4 3
create camera foot position 0.05 0.05 0.3 field_of_view 0.3
create camera far position 0.4 0.4 150
create view v camera whole width 160 height 120
)");
  ASSERT_EQ(world.problem, "");
  for (const char* camera : {"whole", "foot", "far"}) {
    const objdb::Object& object = *world.find(camera);
    ASSERT_TRUE(world.set(object, object.type->find("orientation"), objdb::Quat{0, 0, 1, 0}).ok());
  }
  Studio studio;
  auto seen = [&](const char* camera, const std::string& path) {
    Request request;
    request.view = world.find("v");
    request.camera = world.find(camera);
    Picture picture;
    const Outcome outcome = studio.take(world, request, 0, 0, picture);
    return std::count(outcome.seen.begin(), outcome.seen.end(), path) == 1;
  };
  EXPECT_TRUE(seen("whole", "figure/face"));
  EXPECT_TRUE(seen("foot", "figure/body"));
  EXPECT_FALSE(seen("foot", "figure/face"));
  EXPECT_FALSE(seen("far", "figure/face"));
}

TEST(Stage, AFaceThatDoesNotFitMovesNothingAndIsTold) {
  const std::string file = sheet_file();
  World world(face_type + "create mesh a file " + file + "\ncreate face f skin a vertices 40 81\n");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  auto reason = [&] {
    stage.compose(world, nullptr, 0);
    return stage.reports()[0].reason;
  };
  EXPECT_EQ(reason(), "f: vertex 81 is none of the surface's 81, 0 to 80");
  const objdb::Object& face = *world.find("f");
  auto take = [&](std::vector<std::int64_t> vertices) {
    ASSERT_TRUE(world.set(face, face.type->find("vertices"), std::move(vertices)).ok());
  };
  take({40, 40});
  EXPECT_EQ(reason(), "f: vertex 40 is named twice");
  take({40, 41});
  EXPECT_EQ(reason(), "");
  displace(world, "f", {0, 0, 0.1});
  EXPECT_EQ(reason(), "f: displacement has 1 vectors for 2 vertices");
  EXPECT_EQ(world_bounds(stage.compose(world, nullptr, 0).drawables[0]).max().z(), 0);
  displace(world, "f", {0, 0, 0.1, 0, 0, 0});
  EXPECT_EQ(reason(), "");
  EXPECT_NEAR(world_bounds(stage.compose(world, nullptr, 0).drawables[0]).max().z(), 0.1, 1e-6);
  EXPECT_EQ(stage.reports()[0].status, "ok");
}

TEST(Stage, CamerasLookAtTheirTargets) {
  World world("create sphere ball position 1 2 3\ncreate camera eye position 1 2 -3 target ball\n");
  ASSERT_EQ(world.problem, "");
  const Camera camera = camera_of(world, *world.find("eye"));
  EXPECT_TRUE(camera.X_WC.linear().col(2).isApprox(Eigen::Vector3f::UnitZ(), 1e-6f));
}

TEST(Stage, LightsComeFromWhereTheyArePut) {
  World world("create light sun position 0 3 4\ncreate light lamp kind point position 1 1 1 intensity 2\n");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene scene = stage.compose(world, nullptr, 0);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_TRUE(scene.lights[0].distant);
  EXPECT_TRUE(scene.lights[0].toward.isApprox(Eigen::Vector3f(0, 0.6f, 0.8f), 1e-6f));
  EXPECT_FALSE(scene.lights[1].distant);
}

TEST(Views, AreSwitchedByFields) {
  World world(R"(create joint a lower -1 upper 1
create joint a/b position 0 0.3 0 lower -1 upper 1
create eyeball eye position 0 1 0
create sphere ball position 1 1 1
create view v
)");
  ASSERT_EQ(world.problem, "");
  const objdb::Object& view = *world.find("v");
  Stage stage;
  EXPECT_EQ(helpers(stage.compose(world, &view, 0)), 0);
  auto with = [&](const char* field) {
    const int index = view.type->find(field);
    EXPECT_TRUE(world.set(view, index, std::int64_t{1}).ok());
    const int count = helpers(stage.compose(world, &view, 0));
    EXPECT_TRUE(world.set(view, index, std::int64_t{0}).ok());
    return count;
  };
  EXPECT_EQ(with("bones"), 2);   // one spindle and all axes
  EXPECT_EQ(with("limits"), 3);  // two sectors and all needles
  EXPECT_EQ(with("gaze_rays"), 1);
  EXPECT_EQ(with("muscles"), 0);  // there are none
}

TEST(Views, OverlayWritesValuesTimeAndWords) {
  World world("create sphere ball position 1 2 3\ncreate view v overlay ball.position time \"a word\" nothing.there\n");
  ASSERT_EQ(world.problem, "");
  Stage stage;
  const Scene scene = stage.compose(world, world.find("v"), 1.5);
  ASSERT_EQ(scene.labels.size(), 4u);
  EXPECT_EQ(scene.labels[0].text, "ball.position 1 2 3");
  EXPECT_EQ(scene.labels[1].text, "t = 1.500 s");
  EXPECT_EQ(scene.labels[2].text, "a word");
  EXPECT_EQ(scene.labels[3].text, "nothing.there");
}

TEST(Views, TrailsRememberAsLongAsAsked) {
  World world("create sphere ball\ncreate view v trails ball trail_time 1s\n");
  ASSERT_EQ(world.problem, "");
  const objdb::Object& ball = *world.find("ball");
  Stage stage;
  for (int k = 0; k <= 40; ++k) {
    ASSERT_TRUE(world.set(ball, ball.type->find("position"), objdb::Vec3{0.1 * k, 0, 0}).ok());
    stage.trails().record(world, 0.05 * k);
  }
  const auto& way = stage.trails().of(ball.id);
  EXPECT_NEAR(way.front().time, 1, 0.051);
  EXPECT_NEAR(way.back().position.x(), 4, 1e-6);
  EXPECT_EQ(helpers(stage.compose(world, world.find("v"), 2)), 1);
  stage.trails().record(world, 0);  // time went back
  EXPECT_EQ(stage.trails().of(ball.id).size(), 1u);
}

TEST(Elements, CutLeavesTheFreeFacesOfWhatIsLeft) {
  // 2 x 1 x 1 cubes: together 10 free faces and 20 edges; after the cut one cube with 6 and 12
  ElementMesh mesh;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 2; ++y) {
      for (int z = 0; z < 2; ++z) {
        mesh.rest.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
        mesh.values.push_back(static_cast<float>(x));
      }
    }
  }
  mesh.nodes = mesh.rest;
  auto node = [](int x, int y, int z) { return 4 * x + 2 * y + z; };
  for (int x = 0; x < 2; ++x) {
    mesh.elements.push_back({node(x, 0, 0), node(x + 1, 0, 0), node(x + 1, 1, 0), node(x, 1, 0), node(x, 0, 1),
                             node(x + 1, 0, 1), node(x + 1, 1, 1), node(x, 1, 1)});
  }
  const CutAway whole = cut_away(mesh, {1, 0, 0, 10});
  EXPECT_EQ(whole.faces->triangle_count(), 20u);
  EXPECT_EQ(whole.edges->levels[0].indices.size(), 2u * 20);
  const CutAway half = cut_away(mesh, {1, 0, 0, -1});
  EXPECT_EQ(half.faces->triangle_count(), 12u);
  EXPECT_EQ(half.edges->levels[0].indices.size(), 2u * 12);
  EXPECT_EQ(half.low, 0);
  EXPECT_EQ(half.high, 2);
  // faces look outward: the volume by the divergence theorem is that of one cube
  double volume = 0;
  const auto& indices = half.faces->levels[0].indices;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    volume += half.faces->vertices[indices[i]].position.cast<double>().dot(
                  half.faces->vertices[indices[i + 1]].position.cast<double>().cross(
                      half.faces->vertices[indices[i + 2]].position.cast<double>())) /
              6;
  }
  EXPECT_NEAR(volume, 1, 1e-6);
}

TEST(Studio, DoesNotDrawAnUnchangedWorldAgain) {
  World world("create sphere ball\ncreate view v width 64 height 48\n");
  Studio studio;
  Request request;
  request.view = world.find("v");
  Picture first, second;
  EXPECT_EQ(studio.take(world, request, 0, 7, first).status, "ok");
  EXPECT_EQ(studio.take(world, request, 0, 7, second).status, "ok");
  EXPECT_EQ(studio.drawn(), 1);
  EXPECT_EQ(difference(first, second, 1).worst, 0);
  studio.take(world, request, 0, 8, second);
  EXPECT_EQ(studio.drawn(), 2);
}

TEST(Studio, SaysWhatIsWrongWithAPicture) {
  World world(
      "create sphere ball radius 1\ncreate camera inside\ncreate camera away position 0 0 -5 orientation 0 0 1 0\n");
  ASSERT_EQ(world.problem, "");
  Studio studio;
  Picture picture;
  Request request;
  request.size = Size{64, 48};
  request.camera = world.find("inside");
  EXPECT_EQ(studio.take(world, request, 0, 0, picture).status, "inside");
  request.camera = world.find("away");
  EXPECT_EQ(studio.take(world, request, 0, 0, picture).status, "empty");
  request.size = Size{0, 48};
  EXPECT_EQ(studio.take(world, request, 0, 0, picture).status, "failed");
}

TEST(WorldFile, NamesTheLineAtFault) {
  World world("create sphere ball\n\ncreate sphere ball radius 3kg\n");
  EXPECT_NE(world.problem.find(".dlg:3:"), std::string::npos) << world.problem;
  objdb::Database other;
  EXPECT_NE(read_world("/nowhere.dlg", other).find("/nowhere.dlg:1:1: error io"), std::string::npos);
}

}  // namespace
}  // namespace render
