#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/render/declaration.h"
#include "manipulators/render/gltf.h"
#include "manipulators/render/look.h"
#include "manipulators/render/movie.h"
#include "manipulators/render/request.h"
#include "manipulators/render/sheet.h"
#include "manipulators/render/stage.h"
#include "manipulators/render/world_file.h"

namespace render {
namespace {

std::string scratch(const std::string& name) { return testing::TempDir() + "sailor_film_" + name; }

std::string content(const std::string& path) {
  std::ostringstream all;
  all << std::ifstream(path, std::ios::binary).rdbuf();
  return all.str();
}

bool has_ffmpeg() { return std::system("ffmpeg -version >/dev/null 2>&1") == 0; }

TEST(Movie, FramesFollowSimulatedTimeWhateverTheTicks) {
  for (double tick : {1.0 / 60, 1.0 / 90, 0.04}) {
    std::string problem;
    auto movie = Movie::start(scratch("count"), {8, 8}, 25, 2.0, problem);
    ASSERT_TRUE(movie) << problem;
    const Picture picture({8, 8});
    for (int k = 1; k <= std::lround(2 / tick); ++k) {
      for (int due = movie->due(2.0 + k * tick); due > 0; --due) ASSERT_EQ(movie->add(picture), "");
    }
    EXPECT_EQ(movie->frames(), 50) << tick;
  }
  std::filesystem::remove_all(scratch("count"));
}

TEST(Movie, EqualFramesMakeEqualFiles) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  for (const char* name : {"a.mp4", "b.mp4"}) {
    std::string problem;
    auto movie = Movie::start(scratch(name), {64, 48}, 30, 0, problem);
    ASSERT_TRUE(movie) << problem;
    for (int k = 0; k < 10; ++k) {
      ASSERT_EQ(movie->add(Picture({64, 48}, {static_cast<std::uint8_t>(20 * k), 90, 120, 255})), "");
    }
    ASSERT_EQ(movie->finish(), "");
  }
  EXPECT_GT(content(scratch("a.mp4")).size(), 500u);
  EXPECT_EQ(content(scratch("a.mp4")), content(scratch("b.mp4")));
}

TEST(Movie, SaysWhyItCannotBeMade) {
  std::string problem;
  EXPECT_FALSE(Movie::start(scratch("odd.mp4"), {63, 48}, 30, 0, problem));
  EXPECT_NE(problem.find("63x48"), std::string::npos);
  EXPECT_FALSE(Movie::start(scratch("film.doc"), {64, 48}, 30, 0, problem));
  EXPECT_FALSE(Movie::start("/proc/no/folder", {64, 48}, 30, 0, problem));
  if (!has_ffmpeg()) return;
  // the encoder cannot write there: it is told when the film ends at the latest
  auto movie = Movie::start("/nowhere/film.mp4", {64, 48}, 30, 0, problem);
  ASSERT_TRUE(movie);
  std::string complaint;
  for (int k = 0; k < 50 && complaint.empty(); ++k) complaint = movie->add(Picture({64, 48}));
  if (complaint.empty()) complaint = movie->finish();
  EXPECT_NE(complaint.find("/nowhere/film.mp4"), std::string::npos);
}

// the programs that are found while it lives are those of one folder
class OnlyPath {
 public:
  explicit OnlyPath(const std::string& folder) : before_(getenv("PATH")) { setenv("PATH", folder.c_str(), 1); }
  ~OnlyPath() { setenv("PATH", before_.c_str(), 1); }
  OnlyPath(const OnlyPath&) = delete;
  OnlyPath& operator=(const OnlyPath&) = delete;

 private:
  std::string before_;
};

// what is said about a film of many frames, at the latest when it ends
std::string complaint_about(const std::string& file) {
  std::string problem;
  auto movie = Movie::start(file, {64, 48}, 30, 0, problem);
  if (!movie) return problem;
  std::string complaint;
  for (int k = 0; k < 400 && complaint.empty(); ++k) complaint = movie->add(Picture({64, 48}));
  return complaint.empty() ? movie->finish() : complaint;
}

TEST(Movie, AMissingOrKilledEncoderIsTold) {
  const std::string folder = scratch("encoders");
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder + "/ffmpeg");
  const OnlyPath path(folder);
  EXPECT_NE(complaint_about(scratch("c.mp4")).find("cannot start ffmpeg: No such file"), std::string::npos);
  std::ofstream(folder + "/ffmpeg") << "#!/bin/sh\nread line\nkill -9 $$\n";
  std::filesystem::permissions(folder + "/ffmpeg", std::filesystem::perms::owner_all);
  EXPECT_EQ(complaint_about(scratch("c.mp4")), "ffmpeg was ended by signal 9 at '" + scratch("c.mp4") + "'");
  // what it does when the disk is full (ffmpeg 5.1 under a limit on the size of files)
  std::ofstream(folder + "/ffmpeg")
      << "#!/bin/sh\nread line\necho 'Error writing trailer: No space left' >&2\nexit 1\n";
  EXPECT_EQ(complaint_about(scratch("c.mp4")),
            "ffmpeg failed on '" + scratch("c.mp4") + "': Error writing trailer: No space left ");
  std::filesystem::remove_all(folder);
}

TEST(Movie, AFileNameIsAFileNameAndNoCommand) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  const std::string file = scratch("a'; touch x $(touch y) `z` b.mp4");
  EXPECT_EQ(complaint_about(file), "");
  EXPECT_GT(std::filesystem::file_size(file), 100u);
  std::filesystem::remove(file);
}

TEST(Movie, RefusesAPictureOfAnotherSize) {
  std::string problem;
  auto movie = Movie::start(scratch("size"), {8, 8}, 25, 0, problem);
  ASSERT_TRUE(movie);
  EXPECT_NE(movie->add(Picture({9, 8})), "");
  std::filesystem::remove_all(scratch("size"));
}

TEST(Sheet, HoldsEveryPicture) {
  std::vector<SheetItem> items;
  for (int k = 0; k < 5; ++k)
    items.push_back({Picture({40, 20}, {static_cast<std::uint8_t>(50 * k), 200, 0, 255}), "p"});
  Picture sheet;
  ASSERT_EQ(contact_sheet(items, 3, {40, 40}, sheet), "");
  int found = 0;
  for (int k = 0; k < 5; ++k) {
    int count = 0;
    for (int i = 0; i < sheet.width() * sheet.height(); ++i) {
      count += sheet.at(i % sheet.width(), i / sheet.width()) == Rgba{static_cast<std::uint8_t>(50 * k), 200, 0, 255};
    }
    found += count == 800;
  }
  EXPECT_EQ(found, 5);
  EXPECT_NE(contact_sheet({}, 1, {10, 10}, sheet), "");
}

TEST(Request, ErrorsPointAtTheWord) {
  objdb::Database world;
  ASSERT_EQ(declare_types(declaration, world), "");
  const std::string file = scratch("world.dlg");
  std::ofstream(file) << "create camera front\ncreate sphere ball\ncreate view v\n";
  ASSERT_EQ(read_world(file, world), "");
  auto parsed = [&](std::string_view line) {
    objdb::LineWords words;
    EXPECT_TRUE(words.split(line).ok());
    return parse_request(world, words.words(), {"from", "size", "quality", "with"});
  };
  auto good = parsed("a.png size 64x48 from front quality best with v");
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(good->files, std::vector<std::string>{"a.png"});
  EXPECT_EQ(*good->size, (Size{64, 48}));
  EXPECT_EQ(good->camera->path, "front");
  EXPECT_EQ(parsed("a.png from nobody").error().column, 12);
  EXPECT_EQ(parsed("a.png from nobody").error().kind, objdb::ErrorKind::unknown);
  EXPECT_EQ(parsed("a.png from ball").error().kind, objdb::ErrorKind::type);
  EXPECT_EQ(parsed("a.png size 0x10").error().kind, objdb::ErrorKind::range);
  EXPECT_EQ(parsed("a.png size 10x").error().kind, objdb::ErrorKind::syntax);
  EXPECT_EQ(parsed("a.png size 10x10x").error().kind, objdb::ErrorKind::syntax);
  EXPECT_EQ(parsed("a.png size").error().kind, objdb::ErrorKind::syntax);
  EXPECT_EQ(parsed("a.png quality superb").error().kind, objdb::ErrorKind::range);
}

TEST(Gltf, ReadsBackWithEveryTrianglePlaceAndMove) {
  objdb::Database world;
  ASSERT_EQ(declare_types(declaration, world), "");
  const std::string file = scratch("scene.dlg");
  std::ofstream(file) << R"(create node figure
create node figure/bones
create joint figure/elbow dh 0 0 0 0 lower -3 upper 3
create bone figure/bones/upper from 0 -0.3 0 to 0 0 0 radius 0.05
create bone figure/bones/lower parent figure/elbow from 0 0 0 to 0 0.3 0 radius 0.05
create skin figure/body skeleton figure/bones file not_there.obj
create box crate position 1 2 3 size 0.5 0.5 0.5 color 1 0 0
create camera front position 0 1 4
create view v bones true
)";
  ASSERT_EQ(read_world(file, world), "");
  Stage stage;
  Gltf gltf;
  std::size_t triangles = 0;
  for (int k = 0; k < 5; ++k) {
    const objdb::Object* elbow = world.find("figure/elbow");
    const objdb::Object* crate = world.find("crate");
    ASSERT_TRUE(world.set(*elbow, elbow->type->find("angle"), 0.3 * k).ok());
    ASSERT_TRUE(world.set(*crate, crate->type->find("position"), objdb::Vec3{1 + 0.1 * k, 2, 3}).ok());
    const Scene scene = stage.compose(world, world.find("v"), 0);
    gltf.moment(world, scene, stage.skins(), 10 + 0.5 * k);
    triangles = 0;
    for (const Drawable& one : scene.drawables) triangles += one.helper ? 0 : one.geometry->triangle_count();
  }
  const std::string out = scratch("scene.glb");
  ASSERT_EQ(gltf.write(out), "");

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(out, aiProcess_ValidateDataStructure);
  ASSERT_TRUE(scene) << importer.GetErrorString();
  std::size_t faces = 0;
  unsigned bones = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    faces += scene->mMeshes[m]->mNumFaces;
    bones = std::max(bones, scene->mMeshes[m]->mNumBones);
  }
  EXPECT_EQ(faces, triangles);
  EXPECT_EQ(bones, 2u);
  EXPECT_EQ(scene->mNumCameras, 1u);
  const aiNode* crate = scene->mRootNode->FindNode("crate");
  ASSERT_TRUE(crate);
  EXPECT_NEAR(crate->mTransformation.a4, 1, 1e-6);
  EXPECT_NEAR(crate->mTransformation.c4, 3, 1e-6);
  ASSERT_EQ(scene->mNumAnimations, 1u);
  const aiAnimation& movement = *scene->mAnimations[0];
  EXPECT_NEAR(movement.mDuration / movement.mTicksPerSecond, 2, 1e-6);
  bool crate_moves = false;
  bool forearm_turns = false;
  for (unsigned c = 0; c < movement.mNumChannels; ++c) {
    const aiNodeAnim& channel = *movement.mChannels[c];
    const std::string name = channel.mNodeName.C_Str();
    if (name == "crate") crate_moves = std::abs(channel.mPositionKeys[4].mValue.x - 1.4) < 1e-6;
    if (name == "figure/bones/lower") {
      // a turn of 1.2 rad about z: w = cos 0.6
      forearm_turns = std::abs(channel.mRotationKeys[4].mValue.w - std::cos(0.6)) < 1e-6;
    }
  }
  EXPECT_TRUE(crate_moves);
  EXPECT_TRUE(forearm_turns);
  EXPECT_NE(gltf.write("/nowhere/scene.glb"), "");
  EXPECT_NE(Gltf().write(out), "");
}

}  // namespace
}  // namespace render
