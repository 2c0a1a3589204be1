#include "manipulators/face_fem/face.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/basis.h"
#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/quadrature.h"
#include "manipulators/face_fem/statics.h"
#include "tests/manipulators/face_fem/heads.h"

namespace face {
namespace {

/// The sailor's face, built and factored once for all tests.
struct Sailor {
  mesh::Surface head;
  Face face;
  std::optional<Statics> statics;

  static const Sailor* get() {
    static const std::unique_ptr<Sailor> one = [] {
      auto head = heads::sailor();
      if (!head) return std::unique_ptr<Sailor>();
      auto face = build_face(*head);
      EXPECT_TRUE(face) << face.error().sentence;
      auto made = std::make_unique<Sailor>(Sailor{*head, *face, std::nullopt});
      auto statics = Statics::make(made->face.model);
      EXPECT_TRUE(statics) << statics.error().sentence;
      made->statics = std::move(*statics);
      return made;
    }();
    return one.get();
  }
};

#define SAILOR()                                                                            \
  const Sailor* sailor = Sailor::get();                                                     \
  if (sailor == nullptr) GTEST_SKIP() << "human.zae of assimp-testmodels is not installed"; \
  [[maybe_unused]] const Face& face = sailor->face

/// vertices of the head after a displacement of the carried nodes
std::vector<Eigen::Vector3d> motion(const Face& face, const Field& u) {
  std::vector<float> nodes, vertices(3 * face.carrier.vertices().size());
  for (int n : face.carrier.nodes())
    for (int i = 0; i < 3; ++i) nodes.push_back(float(u(i, n)));
  face.carrier.carry(nodes.data(), vertices.data());
  std::vector<Eigen::Vector3d> moved;
  for (std::size_t k = 0; k < vertices.size(); k += 3)
    moved.push_back(Eigen::Vector3f(vertices[k], vertices[k + 1], vertices[k + 2]).cast<double>());
  return moved;
}

TEST(Face, OfTheSailorPassesEveryCheckAndNoElementFolds) {
  SAILOR();
  EXPECT_TRUE(check(face.model));
  EXPECT_TRUE(turned_corners(face.model).empty());
  EXPECT_TRUE(unused_nodes(face.model).empty());
  EXPECT_GT(sailor->statics->factor().rcond(), 1e-6);
}

TEST(Face, HasAllLandmarksAndMusclesInOrder) {
  SAILOR();
  ASSERT_EQ(face.landmarks.size(), landmark_names.size());
  for (std::size_t k = 0; k < landmark_names.size(); ++k) EXPECT_EQ(face.landmarks[k].name, landmark_names[k]);
  ASSERT_EQ(face.muscles.size(), muscle_names.size());
  for (std::size_t k = 0; k < muscle_names.size(); ++k) EXPECT_EQ(face.muscles[k].name, muscle_names[k]);
  EXPECT_EQ(face.muscle("procerus"),
            int(std::find(muscle_names.begin(), muscle_names.end(), "procerus") - muscle_names.begin()));
  EXPECT_EQ(face.muscle("biceps"), -1);
}

TEST(Face, LandmarksLieWhereTheMeshWasModelled) {
  // read off the mesh in a viewer, vertices are 2 to 4 mm apart there
  SAILOR();
  const auto near = [&](const char* name, double x, double y, double z) {
    EXPECT_LT((face.landmark(name).place - Eigen::Vector3d(x, y, z)).norm(), 0.004) << name;
  };
  near("nose_tip", 0, 1.518, 0.160);
  near("stomion", 0, 1.487, 0.147);
  near("left_mouth_corner", 0.023, 1.486, 0.137);
  near("right_mouth_corner", -0.023, 1.486, 0.137);
  near("left_outer_canthus", 0.042, 1.552, 0.127);
}

TEST(Face, IsMirroredAsTheHeadIs) {
  // the mesh is symmetrical to 0.1 mm; rays and margins are found to 0.5 mm
  SAILOR();
  for (const Landmark& mark : face.landmarks) {
    if (mark.name.rfind("left_", 0) != 0) continue;
    Eigen::Vector3d other = face.landmark("right_" + mark.name.substr(5)).place;
    other.x() = -other.x();
    EXPECT_LT((mark.place - other).norm(), 0.0012) << mark.name;
  }
}

TEST(Face, MusclesReachTissueAndKeepTheirStress) {
  SAILOR();
  const ElementBoxes boxes(face.model);
  for (std::size_t k = 0; k < face.muscles.size(); ++k) {
    const auto load = load_of(face.model, boxes, face.muscles[k]);
    ASSERT_TRUE(load) << load.error().sentence;
    EXPECT_GT(load->inside, 0.6) << face.muscles[k].name;
    double force = 0;
    for (const Strand& s : face.muscles[k].strands) force = std::max(force, s.force);
    EXPECT_LE(force, 100e3 * face.muscle_notes[k].cross_section * 1.0001) << face.muscles[k].name;
    EXPECT_GT(face.muscle_notes[k].cross_section, 4e-6);
  }
}

TEST(Face, SlitsOpen) {
  SAILOR();
  for (const Slit* slit : {&face.lips, &face.lids[0], &face.lids[1]}) {
    ASSERT_EQ(int(slit->pairs.size()), slit->columns * slit->levels);
    ASSERT_EQ(slit->upper_margin.size(), slit->lower_margin.size());
    EXPECT_EQ(slit->upper_margin.front(), slit->lower_margin.front());
    EXPECT_EQ(slit->upper_margin.back(), slit->lower_margin.back());
    for (const SlitPair& pair : slit->pairs) {
      EXPECT_NE(pair.upper, pair.lower);
      const double gap = pair.normal.dot(face.model.nodes[pair.upper] - face.model.nodes[pair.lower]);
      EXPECT_GT(gap, -1e-6);
      EXPECT_LT(gap, slit == &face.lips ? 0.001 : 0.015);
    }
  }
}

TEST(Face, OpeningTheJawPartsTheLips) {
  SAILOR();
  Field shift = Field::Zero(3, Eigen::Index(face.model.nodes.size()));
  const Eigen::AngleAxisd turn(5 * M_PI / 180, face.jaw.axis);
  for (const Support& s : face.model.supports)
    if (s.bone == face.jaw_bone) {
      const Eigen::Vector3d arm = face.model.nodes[s.node] - face.jaw.centre;
      shift.col(s.node) = turn * arm - arm;
    }
  const Field u = sailor->statics->solve(Field::Zero(3, shift.cols()), shift).u;
  const std::size_t middle = face.lips.upper_margin.size() / 2;
  const double gap = u(1, face.lips.upper_margin[middle]) - u(1, face.lips.lower_margin[middle]);
  // the chin, 0.10 m from the condyles, falls by 8 mm; the lips open by most of it
  EXPECT_GT(gap, 0.004);
  EXPECT_LT(gap, 0.012);
}

TEST(Face, MotionOfTheHeadIsSmoothAndEndsAtZero) {
  SAILOR();
  const ElementBoxes boxes(face.model);
  const auto load = load_of(face.model, boxes, face.muscles[face.muscle("left_zygomaticus_major")]);
  ASSERT_TRUE(load);
  const std::vector<Eigen::Vector3d> moved = motion(face, sailor->statics->solve(load->load).u);
  std::vector<Eigen::Vector3d> all(sailor->head.V.rows(), Eigen::Vector3d::Zero());
  for (std::size_t k = 0; k < moved.size(); ++k) all[face.carrier.vertices()[k]] = moved[k];
  double largest = 0, jump = 0;
  for (Eigen::Index f = 0; f < sailor->head.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = sailor->head.F(f, k), b = sailor->head.F(f, (k + 1) % 3);
      const double length = (sailor->head.V.row(a) - sailor->head.V.row(b)).norm();
      largest = std::max(largest, all[a].norm());
      // strain of an edge where nothing is pulled: behind the ears and below the chin the motion has to die away softly
      if (sailor->head.V(a, 2) < 0.06 && length > 1e-4) jump = std::max(jump, (all[a] - all[b]).norm() / length);
    }
  EXPECT_GT(largest, 0.003);
  EXPECT_LT(jump, 0.05);
}

TEST(Face, IsTheSameEveryTime) {
  SAILOR();
  const auto again = build_face(sailor->head);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->model.nodes, face.model.nodes);
  EXPECT_EQ(again->carrier.vertices(), face.carrier.vertices());
}

TEST(Face, OtherHeadsTooAreFaces) {
  for (const auto& [name, head] :
       {std::pair("ICT-FaceKit", heads::ict()), std::pair("MakeHuman", heads::makehuman())}) {
    if (!head) GTEST_SKIP() << name << " is not there; set SAILOR_DATA to the folder of reference data";
    for (const int n : {16, 32, 48}) {
      FaceOptions options;
      options.columns = options.rows = n;
      const auto face = build_face(*head, options);
      ASSERT_TRUE(face) << name << " " << n << ": " << face.error().sentence;
      const ElementBoxes boxes(face->model);
      for (const Muscle& muscle : face->muscles) {
        const auto load = load_of(face->model, boxes, muscle);
        EXPECT_TRUE(load) << name << " " << n << ": " << load.error().sentence;
      }
    }
  }
}

/// a ball with as many faces as a head, the size of one
mesh::Surface ball() {
  mesh::Surface s;
  constexpr int across = 60, up = 40;
  s.part_names = {"ball"};
  s.V.resize(across * (up + 1), 3);
  for (int j = 0; j <= up; ++j)
    for (int i = 0; i < across; ++i) {
      const double a = 2 * M_PI * i / across, b = M_PI * (j - up / 2.0) / (up + 1);
      s.V.row(j * across + i) << float(0.1 * std::sin(a) * std::cos(b)), float(0.12 * std::sin(b)),
          float(0.1 * std::cos(a) * std::cos(b));
    }
  s.F.resize(2 * across * up, 3);
  for (int j = 0, f = 0; j < up; ++j)
    for (int i = 0; i < across; ++i) {
      const int a = j * across + i, b = j * across + (i + 1) % across;
      s.F.row(f++) << a, b, b + across;
      s.F.row(f++) << a, b + across, a + across;
    }
  s.part.assign(s.F.rows(), 0);
  return s;
}

Fault fault_of(const Result<Face>& result) {
  EXPECT_FALSE(result);
  EXPECT_FALSE(!result && result.error().sentence.empty());
  return result ? Fault::io : result.error().fault;
}

TEST(Face, WhatIsNoHeadIsRefusedByName) {
  EXPECT_EQ(fault_of(build_face(mesh::Surface())), Fault::mesh);
  EXPECT_EQ(fault_of(build_face(ball())), Fault::landmark);
  mesh::Surface tiny = ball();
  tiny.V *= 0.01F;
  EXPECT_EQ(fault_of(build_face(tiny)), Fault::mesh);
  mesh::Surface bad = ball();
  bad.V(3, 1) = NAN;
  EXPECT_EQ(fault_of(build_face(bad)), Fault::not_finite);
}

TEST(Face, HeadsThatCannotBeReadAreRefusedByName) {
  SAILOR();
  // a hole of 40 mm in the cheek
  std::vector<bool> keep;
  for (Eigen::Index f = 0; f < sailor->head.F.rows(); ++f) {
    const Eigen::RowVector3f p = sailor->head.V.row(sailor->head.F(f, 0));
    keep.push_back(!(std::abs(p.x() - 0.04F) < 0.02F && std::abs(p.y() - 1.51F) < 0.02F && p.z() > 0.05F));
  }
  EXPECT_EQ(fault_of(build_face(mesh::subset(sailor->head, keep))), Fault::mesh);
  // looking sideways, backward, standing on its head, three times too tall
  const auto turned = [&](const Eigen::Vector3f& axis, double degrees, float size) {
    mesh::Surface other = sailor->head;
    const Eigen::Matrix3f turn = Eigen::AngleAxisf(float(degrees * M_PI / 180), axis).toRotationMatrix();
    other.V = (size * other.V * turn.transpose()).eval();
    return fault_of(build_face(other));
  };
  EXPECT_EQ(turned(Eigen::Vector3f::UnitY(), 90, 1), Fault::landmark);
  EXPECT_EQ(turned(Eigen::Vector3f::UnitY(), 180, 1), Fault::landmark);
  EXPECT_EQ(turned(Eigen::Vector3f::UnitX(), 180, 1), Fault::landmark);
  EXPECT_EQ(turned(Eigen::Vector3f::UnitX(), 0, 3), Fault::landmark);
}

TEST(Face, NoiseOfAMillimetreAndOtherPlacesDoNotMatter) {
  SAILOR();
  mesh::Surface other = sailor->head;
  unsigned state = 1;
  for (Eigen::Index v = 0; v < other.V.rows(); ++v)
    for (int i = 0; i < 3; ++i) {
      state = state * 1664525U + 1013904223U;
      other.V(v, i) += 0.002F * (float(state >> 8) / 16777216.0F - 0.5F) + (i == 0 ? 3.0F : i == 1 ? -7.0F : 2.0F);
    }
  const auto moved = build_face(other);
  ASSERT_TRUE(moved) << moved.error().sentence;
  for (const Landmark& mark : moved->landmarks)
    EXPECT_LT((mark.place - Eigen::Vector3d(3, -7, 2) - face.landmark(mark.name).place).norm(), 0.006) << mark.name;
}

TEST(Face, OptionsOutOfRangeAreRefused) {
  const auto with = [](auto change) {
    FaceOptions options;
    change(options);
    return fault_of(build_face(ball(), options));
  };
  EXPECT_EQ(with([](FaceOptions& o) { o.columns = 15; }), Fault::limit);
  EXPECT_EQ(with([](FaceOptions& o) { o.rows = 4; }), Fault::limit);
  EXPECT_EQ(with([](FaceOptions& o) { o.layers = 2; }), Fault::limit);
  EXPECT_EQ(with([](FaceOptions& o) { o.element = Element::hex20; }), Fault::limit);
  EXPECT_EQ(with([](FaceOptions& o) { o.depth_scale = NAN; }), Fault::limit);
  EXPECT_EQ(with([](FaceOptions& o) { o.landmarks["tail"] = Eigen::Vector3d::Zero(); }), Fault::unknown);
}

TEST(Face, GivenLandmarksReplaceWhatIsFound) {
  SAILOR();
  FaceOptions options;
  options.landmarks["left_mouth_corner"] = face.landmark("left_mouth_corner").place + Eigen::Vector3d(0.003, 0, -0.002);
  const auto other = build_face(sailor->head, options);
  ASSERT_TRUE(other) << other.error().sentence;
  EXPECT_EQ(other->landmark("left_mouth_corner").place, options.landmarks["left_mouth_corner"]);
  EXPECT_EQ(other->landmark("left_mouth_corner").source, "given");
}

}  // namespace
}  // namespace face
