#include "manipulators/render/picture.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "manipulators/render/smooth.h"

namespace render {
namespace {

std::string scratch(const std::string& name) { return testing::TempDir() + "sailor_picture_" + name; }

Picture gradient(Size size) {
  Picture picture(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      picture.put(x, y, {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 7, 255});
    }
  }
  return picture;
}

TEST(Picture, SurvivesPng) {
  const Picture out = gradient({37, 21});
  const std::string file = scratch("round.png");
  ASSERT_EQ(write_png(out, file), "");
  Picture in;
  ASSERT_EQ(read_png(file, in), "");
  ASSERT_EQ(in.size(), out.size());
  EXPECT_EQ(std::vector(in.data(), in.data() + in.byte_count()),
            std::vector(out.data(), out.data() + out.byte_count()));
  EXPECT_FALSE(std::filesystem::exists(file + ".part"));
}

TEST(Picture, SaysWhyAFileCannotBeWrittenOrRead) {
  EXPECT_NE(write_png(gradient({4, 4}), "/nowhere/at/all.png").find("/nowhere/at/all.png"), std::string::npos);
  Picture in;
  EXPECT_NE(read_png("/nowhere/at/all.png", in).find("cannot read"), std::string::npos);
  const std::string file = scratch("broken.png");
  std::ofstream(file) << "not a picture";
  EXPECT_NE(read_png(file, in), "");
}

TEST(Picture, RefusesSizesThatCannotBeDrawn) {
  EXPECT_EQ(size_problem({1, 1}), "");
  EXPECT_EQ(size_problem({1280, 720}), "");
  for (Size bad : {Size{0, 10}, Size{10, 0}, Size{-1, 5}, Size{largest_side + 1, 1}, Size{16384, 16384}}) {
    EXPECT_NE(size_problem(bad), "") << bad.width << "x" << bad.height;
  }
  EXPECT_NE(write_png(Picture(), scratch("empty.png")), "");
}

TEST(Picture, DifferenceForgivesOnePixelAndSeesAPatch) {
  Picture a({64, 64}, {120, 120, 120, 255});
  Picture b = a;
  EXPECT_EQ(difference(a, b).worst, 0);
  // one pixel 30 levels brighter moves the mean of an 8 x 8 cell by half a level: far below noticeable (2.3)
  b.put(10, 10, {150, 150, 150, 255});
  EXPECT_LT(difference(a, b).worst, 1);
  for (int y = 16; y < 24; ++y) {
    for (int x = 16; x < 24; ++x) b.put(x, y, {200, 60, 60, 255});
  }
  EXPECT_GT(difference(a, b).worst, 20);
  EXPECT_FALSE(difference(a, Picture({64, 63})).same_size);
}

TEST(Picture, LabDistanceOfBlackAndWhiteIsOneHundred) {
  // L* runs from 0 to 100 by definition
  EXPECT_NEAR(difference(Picture({8, 8}, {0, 0, 0, 255}), Picture({8, 8}, {255, 255, 255, 255})).worst, 100, 0.01);
}

TEST(Picture, PasteAndOutlineAreClipped) {
  Picture base({10, 10}, {0, 0, 0, 255});
  paste(Picture({4, 4}, {255, 0, 0, 255}), base, -2, -2);
  EXPECT_EQ(base.at(1, 1), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(base.at(2, 2), (Rgba{0, 0, 0, 255}));
  paste(Picture({4, 4}, {0, 255, 0, 255}), base, 8, 8);
  EXPECT_EQ(base.at(9, 9), (Rgba{0, 255, 0, 255}));
  paste(Picture({4, 4}), base, 100, 100);
  outline(base, -1, -1, {12, 12}, 2, {1, 2, 3, 255});
  EXPECT_EQ(base.at(0, 5), (Rgba{1, 2, 3, 255}));
  EXPECT_EQ(base.at(1, 5), (Rgba{0, 0, 0, 255}));
}

TEST(Picture, ResizingKeepsTheMean) {
  const Picture from = gradient({200, 120});
  for (Size size : {Size{50, 30}, Size{100, 60}, Size{37, 91}, Size{400, 240}}) {
    const Picture to = resized(from, size);
    double mean[2] = {0, 0};
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        mean[0] += to.at(x, y)[0];
        mean[1] += to.at(x, y)[1];
      }
    }
    // means of 0..199 and 0..119; half a level of rounding and the clipped filter at the borders
    EXPECT_NEAR(mean[0] / (size.width * size.height), 99.5, 0.6);
    EXPECT_NEAR(mean[1] / (size.width * size.height), 59.5, 0.6);
  }
}

TEST(Smooth, LeavesFlatAndStraightAloneAndSoftensSteps) {
  Picture flat({32, 32}, {90, 140, 30, 255});
  Picture same = flat;
  smooth_edges(same);
  EXPECT_EQ(difference(flat, same, 1).worst, 0);

  // an edge of slope 1/8: after smoothing there are intermediate values, and the mean has not moved
  Picture slope({64, 64}, {0, 0, 0, 255});
  double before = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (y * 8 > x + 200) slope.put(x, y, {255, 255, 255, 255});
      before += slope.at(x, y)[0];
    }
  }
  smooth_edges(slope);
  double after = 0;
  int between = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const int value = slope.at(x, y)[0];
      after += value;
      between += value > 20 && value < 235;
    }
  }
  EXPECT_GT(between, 40);  // 64 columns cross the edge
  EXPECT_NEAR(after / before, 1, 0.01);
}

TEST(Smooth, ToleratesTinyPictures) {
  for (Size size : {Size{1, 1}, Size{2, 5}, Size{3, 3}}) {
    Picture picture(size);
    smooth_edges(picture);
    EXPECT_EQ(picture.size(), size);
  }
}

}  // namespace
}  // namespace render
