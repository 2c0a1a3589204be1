#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "manipulators/face_fem/face_chart.h"
#include "manipulators/face_fem/face_sheet.h"
#include "manipulators/face_fem/face_tissue.h"
#include "manipulators/face_fem/range_scan.h"
#include "manipulators/face_fem/warp.h"
#include "tests/manipulators/face_fem/heads.h"

namespace face {
namespace {

using Eigen::Vector3d;

FaceChart a_chart() {
  FaceChart chart;
  chart.x = 0.001;
  chart.z = 0.05;
  chart.lower = 1.47;
  chart.upper = 1.57;
  chart.bottom = 1.44;
  chart.top = 1.63;
  return chart;
}

TEST(FaceChart, PointsAndPlacesAreInverse) {
  const FaceChart chart = a_chart();
  for (double y = 1.40; y < 1.66; y += 0.013)
    for (double angle = -1.5; angle < 1.6; angle += 0.21) {
      const Vector3d p(chart.x + 0.08 * std::sin(angle), y, chart.z + 0.08 * std::cos(angle));
      EXPECT_LT((chart.point(chart.of(p)) - p).norm(), 1e-14);
    }
}

TEST(FaceChart, RaysOfABallAreAsLongAsTheGeometrySays) {
  // a ball round the upper bend, where the rays fan out: all radii are the ball's
  const FaceChart chart = a_chart();
  for (double height = chart.upper; height < chart.top; height += 0.01) {
    const Vector3d p = chart.point({0.3, height, 0.08});
    EXPECT_NEAR((p - Vector3d(chart.x, chart.upper, chart.z)).norm(), 0.08, 1e-14);
  }
}

TEST(Warp, MeetsItsPairsAndKeepsAffineMaps) {
  std::vector<Vector3d> from = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0.3, 0.6, 0.2}}, to;
  Eigen::Matrix3d A;
  A << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.1, 1.2;
  for (const Vector3d& p : from) to.push_back(A * p + Vector3d(1, 2, 3));
  const Warp affine(from, to);
  EXPECT_LT((affine({0.4, -2, 5}) - (A * Vector3d(0.4, -2, 5) + Vector3d(1, 2, 3))).norm(), 1e-12);
  to[5] += Vector3d(0.05, 0, -0.02);
  const Warp bent(from, to);
  for (std::size_t k = 0; k < from.size(); ++k) EXPECT_LT((bent(from[k]) - to[k]).norm(), 1e-12);
}

TEST(BoneRadius, UnderAPlaneIsTheDepth) {
  // skin points of a plane square to the ray, half a millimetre apart
  FaceChart chart;
  std::vector<Vector3d> skin;
  for (int i = -60; i <= 60; ++i)
    for (int j = -60; j <= 60; ++j) skin.push_back({0.0005 * i, 0.0005 * j, 0.1});
  EXPECT_NEAR(bone_radius(chart, {0, 0, 0.1}, 0.006, skin), 0.094, 1e-9);
}

TEST(BoneRadius, DepthIsSquareToSlantedSkin) {
  // a plane at 45 degrees to the ray: along it the tissue is thicker by the square root of two
  FaceChart chart;
  std::vector<Vector3d> skin;
  for (int i = -80; i <= 80; ++i)
    for (int j = -80; j <= 80; ++j) skin.push_back({0.0004 * i, 0.0004 * j, 0.1 + 0.0004 * j});
  EXPECT_NEAR(bone_radius(chart, {0, 0, 0.1}, 0.006, skin), 0.1 - 0.006 * std::sqrt(2.0), 1e-5);
}

/// a small scan whose nose looks to -X, wound inward
std::string a_scan(const std::string& tail) {
  std::ostringstream text;
  text << "# vtk DataFile Version 3.0\nscan\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 9 7 1\nPOINTS 63 float\n";
  for (int j = 0; j < 7; ++j)
    for (int i = 0; i < 9; ++i) {
      const double a = -M_PI / 2 + (i - 4) * 0.2, r = 0.09 + (i == 4 && j == 3 ? 0.02 : 0);
      text << r * std::sin(a) << ' ' << 0.02 * j << ' ' << r * std::cos(a) << '\n';
    }
  return text.str() + tail;
}

TEST(RangeScan, TurnsTheNoseForwardAndFacesOutward) {
  const auto scan = parse_range_scan(a_scan(""), "scan.vtk");
  ASSERT_TRUE(scan) << scan.error().sentence;
  EXPECT_EQ(scan->F.rows(), 2 * 8 * 6);
  EXPECT_NEAR(scan->V(3 * 9 + 4, 0), 0, 1e-6);
  EXPECT_NEAR(scan->V(3 * 9 + 4, 2), 0.11, 1e-6);
  for (Eigen::Index f = 0; f < scan->F.rows(); ++f) {
    const Eigen::Vector3f a = scan->V.row(scan->F(f, 0)), b = scan->V.row(scan->F(f, 1)),
                          c = scan->V.row(scan->F(f, 2));
    EXPECT_GT((b - a).cross(c - a).dot(a), 0);
  }
}

TEST(RangeScan, BrokenFilesAreRefusedByLine) {
  const auto fault = [](const std::string& text) {
    const auto scan = parse_range_scan(text, "s.vtk");
    EXPECT_FALSE(scan);
    return scan ? std::string() : std::string(name_of(scan.error().fault)) + " " + scan.error().sentence;
  };
  EXPECT_EQ(fault("solid cube"), "syntax s.vtk:1: a range scan starts with '# vtk DataFile'");
  EXPECT_EQ(fault(a_scan("").substr(0, a_scan("").find('\n', 300))).rfind("truncated s.vtk", 0), 0U);
  std::string bad = a_scan("");
  bad.replace(bad.find("DIMENSIONS 9 7 1"), 16, "DIMENSIONS 9 8 1");
  EXPECT_EQ(fault(bad), "syntax s.vtk: 9 x 8 points expected, has 63");
  bad = a_scan("");
  bad.replace(bad.find("63 float\n") + 9, 3, "x ");
  EXPECT_EQ(fault(bad).rfind("syntax s.vtk:7: a coordinate must be a number", 0), 0U) << fault(bad);
  EXPECT_EQ(fault("# vtk DataFile Version 3.0\nt\nBINARY\n"),
            "syntax s.vtk:3: only ASCII scans are read, this is 'BINARY'");
  EXPECT_EQ(fault("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS "
                  "1 4\n3 0 1 7\n"),
            "unknown s.vtk: polygon 0 names a point that is not there");
}

TEST(RangeScan, OfARealPersonBecomesAFace) {
  const auto scan = read_range_scan(heads::data("head/fran_cut.vtk"));
  if (!scan && scan.error().fault == Fault::io) GTEST_SKIP() << scan.error().sentence << "; set SAILOR_DATA";
  ASSERT_TRUE(scan) << scan.error().sentence;
  const auto face = build_face(*scan);
  ASSERT_TRUE(face) << face.error().sentence;
  // eyes are not seen as parts or openings, so they are guesses, and said to be
  EXPECT_EQ(face->landmark("left_upper_lid").source, "proportion");
  EXPECT_FALSE(face->notes.empty());
  EXPECT_EQ(face->landmark("nose_tip").source, "profile");
  const double mouth = face->landmark("left_mouth_corner").place.x() - face->landmark("right_mouth_corner").place.x();
  EXPECT_GT(mouth, 0.040);
  EXPECT_LT(mouth, 0.080);
}

/// One computed-tomography head as radii of skin and bone by slice and angle, metres; NaN where nothing is met.
struct Tomography {
  static constexpr int angles = 256;
  int slices = 0;
  std::vector<double> skin, bone;

  static double height(int slice) { return -0.0015 * slice; }
  double at(const std::vector<double>& radius, const Vector3d& p) const {
    const int s = int(std::lround(-p.y() / 0.0015));
    const int a = (int(std::lround(std::atan2(p.x(), p.z()) / (2 * M_PI) * angles)) + angles) % angles;
    return s < 0 || s >= slices ? NAN : radius[s * angles + a];
  }
};

std::optional<Tomography> tomography() {
  const std::string path = heads::data("skull/headsq_cylinder_skin_bone.csv.gz");
  if (!std::ifstream(path)) return std::nullopt;
  std::FILE* pipe = popen(("gzip -dc " + path).c_str(), "r");
  Tomography head;
  char line[200];
  while (std::fgets(line, sizeof line, pipe) != nullptr) {
    int slice = 0;
    double z = 0, theta = 0, skin = NAN, bone = NAN;
    if (std::sscanf(line, "%d,%lf,%lf,%lf,%lf", &slice, &z, &theta, &skin, &bone) < 3) continue;
    head.slices = slice + 1;
    // a few rays of the lowest slices meet no skin
    head.skin.push_back(std::isfinite(skin) || head.skin.empty() ? skin * 1e-3 : head.skin.back());
    head.bone.push_back(bone * 1e-3);
  }
  pclose(pipe);
  return head;
}

TEST(TissueDepth, AgreesWithATomographyOfAHead) {
  const auto ct = tomography();
  if (!ct) GTEST_SKIP() << "the tomography is not there; set SAILOR_DATA to the folder of reference data";
  ASSERT_EQ(ct->skin.size(), std::size_t(ct->slices) * Tomography::angles);
  // its skin as a surface, then the bone that the builder lays under it
  mesh::Surface skin;
  skin.part_names = {"skin"};
  skin.V.resize(Eigen::Index(ct->skin.size()), 3);
  for (int s = 0; s < ct->slices; ++s)
    for (int a = 0; a < Tomography::angles; ++a) {
      const double r = ct->skin[s * Tomography::angles + a], theta = 2 * M_PI * a / Tomography::angles;
      skin.V.row(s * Tomography::angles + a) << float(r * std::sin(theta)), float(Tomography::height(s)),
          float(r * std::cos(theta));
    }
  skin.F.resize(Eigen::Index(2) * (ct->slices - 1) * Tomography::angles, 3);
  for (int s = 0, f = 0; s + 1 < ct->slices; ++s)
    for (int a = 0; a < Tomography::angles; ++a) {
      const int here = s * Tomography::angles + a, next = s * Tomography::angles + (a + 1) % Tomography::angles;
      skin.F.row(f++) << here, here + Tomography::angles, next;
      skin.F.row(f++) << next, here + Tomography::angles, next + Tomography::angles;
    }
  skin.part.assign(skin.F.rows(), 0);
  const auto head = Head::take(skin);
  ASSERT_TRUE(head) << head.error().sentence;
  // a tube in the mouth and the missing crown mislead the finder: heights read off its picture, depth beside the tube
  std::map<std::string, Vector3d> given;
  const auto give = [&](const char* name, double x, double y, double beside) {
    const auto z = head->front(beside, y);
    ASSERT_TRUE(z) << name;
    given[name] = {x, y, *z};
  };
  const std::pair<const char*, double> profile[] = {
      {"glabella", -0.010},  {"nasion", -0.026},   {"nose_tip", -0.070},   {"subnasale", -0.081},
      {"upper_lip", -0.090}, {"stomion", -0.0965}, {"lower_lip", -0.1060}, {"labiomental", -0.1160},
      {"chin", -0.125},      {"menton", -0.1355}};
  for (const auto& [name, y] : profile) give(name, -0.004, y, y < -0.085 ? 0.006 : -0.004);
  give("left_mouth_corner", 0.0185, -0.0975, 0.0185);
  give("right_mouth_corner", -0.0265, -0.0975, -0.0265);
  const auto marks = find_landmarks(*head, given);
  ASSERT_TRUE(marks) << marks.error().sentence;
  const auto sheet = lay_sheet(*head, *marks, 32, 32);
  ASSERT_TRUE(sheet) << sheet.error().sentence;
  const FaceTissue tissue = stack_tissue(*head, *marks, *sheet, {});
  std::vector<double> miss;
  for (std::size_t k = 0; k < tissue.bed.size(); ++k) {
    if (tissue.bed[k] != Bed::skull && tissue.bed[k] != Bed::jaw) continue;
    const Vector3d& p = tissue.model.nodes[tissue.node[k].front()];
    const double bone = ct->at(ct->bone, p), surface = ct->at(ct->skin, p);
    // where the scanned radius passes the bone (orbit, below the cheekbone) it says nothing of the tissue
    if (!(surface - bone < 0.020)) continue;
    miss.push_back(std::hypot(p.x(), p.z()) - bone);
  }
  ASSERT_GT(miss.size(), 200U);
  std::vector<double> size;
  double mean = 0;
  for (double m : miss) size.push_back(std::abs(m)), mean += m / double(miss.size());
  std::nth_element(size.begin(), size.begin() + size.size() / 2, size.end());
  std::printf("bone under the skin of a CT head: %zu places, mean %+.1f mm, median size %.1f mm\n", miss.size(),
              1e3 * mean, 1e3 * size[size.size() / 2]);
  // one head against means of thousands: standard deviations of tissue depth are 1 to 4 mm, voxels are 3.2 mm wide
  EXPECT_LT(std::abs(mean), 0.003);
  EXPECT_LT(size[size.size() / 2], 0.004);
}

}  // namespace
}  // namespace face
