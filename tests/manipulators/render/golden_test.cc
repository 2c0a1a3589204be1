#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "manipulators/render/declaration.h"
#include "manipulators/render/studio.h"
#include "manipulators/render/world_file.h"

namespace render {
namespace {

// Three small pictures that somebody has looked at. The comparison is of cells of 8 x 8 pixels in CIE Lab, where 2.3 is
// just noticeable: other rasterizers round and cover edges differently, but a missing shadow, a turned normal or a
// wrong colour moves some cell by 10 and more. SAILOR_WRITE_GOLDEN=1 writes them anew.
struct Golden {
  const char* name;
  const char* world;
};

const Golden pictures[] = {
    {"shapes", R"(create box crate position 0.5 0.2 0 size 0.4 0.4 0.4 color 0.2 0.4 0.7
create sphere ball position 0 0.25 0.1 radius 0.25 color 0.85 0.2 0.15 shininess 0.8
create cylinder post position -0.55 0.3 0 radius 0.15 length 0.6 color 0.9 0.9 0.88
create capsule rod position -0.2 0.08 0.5 orientation 0.7071067811865476 0 0 0.7071067811865476 radius 0.08 length 0.3 color 0.2 0.6 0.4
create node middle position 0 0.2 0
create camera c position 0.8 1 2.4 target middle field_of_view 0.6
create view v width 192 height 128 camera c
)"},
    {"eyes", R"(create eyeball left position 0.13 0 0 radius 0.1 iris 0.05 pupil 0.016 lids true color 0.8 0.6 0.5
create eyeball right position -0.13 0 0 orientation 0.9689 0 0.2474 0 radius 0.1 iris 0.05 pupil 0.03 lids true upper_lid 0.1 color 0.8 0.6 0.5
create camera c position 0 0.05 0.8 field_of_view 0.5 orientation 0 0 1 0
create view v width 192 height 128 camera c ground none
)"},
    {"views",
     R"(create joint a orientation 0.7071067811865476 -0.7071067811865476 0 0 dh 0 0.4 0 1.5707963 angle 0.4 lower -1 upper 1
create joint b parent a dh 0 0 0.3 0 angle 0.8 lower -0.5 upper 2
create joint c parent b dh 0 0 0.2 0 angle 0.2 lower 0 upper 1.5
create eyeball eye position 0.5 0.5 0 radius 0.1 iris 0.05
create camera cam position 0.6 0.8 2.2 target b field_of_view 0.6
create view v width 192 height 128 camera cam ground grid bones true limits true gaze_rays true
)"},
};

TEST(Golden, PicturesLookAsTheyDid) {
  for (const Golden& golden : pictures) {
    objdb::Database world;
    ASSERT_EQ(declare_types(declaration, world), "");
    const std::string file = testing::TempDir() + "sailor_golden.dlg";
    std::ofstream(file) << golden.world;
    ASSERT_EQ(read_world(file, world), "");
    Studio studio;
    Request request;
    request.view = world.find("v");
    Picture picture;
    ASSERT_EQ(studio.take(world, request, 0, 0, picture).status, "ok") << golden.name;
    const std::string path = std::string(SOURCE_DIR) + "/tests/manipulators/render/golden/" + golden.name + ".png";
    if (std::getenv("SAILOR_WRITE_GOLDEN")) {
      ASSERT_EQ(write_png(picture, path), "");
    }
    Picture expected;
    ASSERT_EQ(read_png(path, expected), "");
    const Difference found = difference(picture, expected);
    EXPECT_TRUE(found.same_size);
    EXPECT_LT(found.mean, 0.7) << golden.name;
    EXPECT_LT(found.worst, 7) << golden.name;
  }
}

}  // namespace
}  // namespace render
