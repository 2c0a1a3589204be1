#include "manipulators/face_fem/expressions.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/face_fem/actor.h"
#include "manipulators/face_fem/strength.h"
#include "manipulators/mesh/read.h"

namespace face {
namespace {

const char* const body_file = "/usr/share/assimp/models/Collada/human.zae";

// the face of the sailor's body, made once
class Expression : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!std::filesystem::exists(body_file)) return;
    auto read = mesh::read_surface(body_file);
    ASSERT_TRUE(read) << read.error().sentence;
    body = new mesh::Surface(std::move(*read));
    auto built = build_face(*body);
    ASSERT_TRUE(built.ok()) << built.error().sentence;
    auto made = Actor::make(strengthened(std::move(*built)));
    ASSERT_TRUE(made.ok()) << made.error().sentence;
    actor = made->release();
    actor->set_surface(body->V);
  }
  static void TearDownTestSuite() {
    delete actor;
    delete body;
  }
  void SetUp() override {
    if (actor == nullptr) GTEST_SKIP() << body_file << " is not there";
  }

  static Drive drive(const std::vector<std::string_view>& words) {
    std::vector<std::string> names;
    for (const Muscle& muscle : actor->face().muscles) names.push_back(muscle.name);
    Levels levels{};
    const auto parts = parse_parts(words);
    for (const auto& [place, level] : *parts) levels[std::size_t(place)] = level;
    Habits habits;
    habits.aperture = actor->aperture();
    return Driver(names).drive(levels, {}, habits);
  }
  static Eigen::Vector3d moved(const Frame& frame, const std::string& landmark) {
    const Eigen::Vector3d p = actor->face().landmark(landmark).place;
    std::size_t best = 0;
    double nearest = 1;
    for (std::size_t k = 0; k < actor->vertices().size(); ++k) {
      const double away = (body->V.row(actor->vertices()[k]).transpose().cast<double>() - p).norm();
      if (away < nearest) best = k, nearest = away;
    }
    return Eigen::Map<const Eigen::Vector3f>(&frame.displacement[3 * best]).cast<double>();
  }

  static inline Actor* actor = nullptr;
  static inline mesh::Surface* body = nullptr;
};

TEST_F(Expression, EveryUnitPullsMusclesThatTheFaceHas) {
  std::vector<std::string> names;
  for (const Muscle& muscle : actor->face().muscles) names.push_back(muscle.name);
  EXPECT_EQ(Driver(names).missing(), std::vector<std::string>());
}

// 11 to 14 mm is what people's corners travel (Flynn et al. 2018)
TEST_F(Expression, AFullSmileMovesTheCornersAsPeopleDo) {
  const Frame frame = actor->frame(drive({"AU12"}), FaceMethod::contact);
  for (const std::string side : {"left_", "right_"}) {
    const Eigen::Vector3d corner = moved(frame, side + "mouth_corner");
    EXPECT_GT(corner.norm(), 0.011) << side;
    EXPECT_LT(corner.norm(), 0.014) << side;
    EXPECT_GT(corner.y(), 0.5 * corner.norm()) << side;
    EXPECT_GT(corner.x() * (side == "left_" ? 1 : -1), 0) << side;
  }
}

TEST_F(Expression, BrowsAndCornersGoWhereTheirNamesSay) {
  const auto up = [&](std::string_view unit, const char* landmark) {
    return moved(actor->frame(drive({unit}), FaceMethod::contact), landmark).y();
  };
  EXPECT_GT(up("AU1", "left_brow_inner"), 0.003);
  EXPECT_GT(up("AU2", "left_brow_outer"), 0.002);
  EXPECT_LT(up("AU4", "left_brow_inner"), -0.002);
  EXPECT_LT(up("AU15", "left_mouth_corner"), -0.002);
  EXPECT_GT(up("AU9", "left_nose_wing"), 0.0015);
  EXPECT_LT(up("AU27", "chin"), -0.015);
}

TEST_F(Expression, ABlinkShutsTheLidsOutsideTheEyeball) {
  const Frame frame = actor->frame(drive({"AU45"}), FaceMethod::contact);
  const Field u = actor->field(drive({"AU45"}));
  const Model& model = actor->face().model;
  for (std::size_t side : {0, 1})
    for (const SlitPair& pair : actor->face().lids[side].pairs) {
      if (pair.level == 0) continue;
      const Eigen::Vector3d upper = model.nodes[std::size_t(pair.upper)] + u.col(pair.upper);
      const Eigen::Vector3d lower = model.nodes[std::size_t(pair.lower)] + u.col(pair.lower);
      // polynomials between samples: a hundredth of a millimetre
      EXPECT_LT((upper - lower).norm(), 2e-5);
    }
  for (std::size_t k = 0; k < actor->vertices().size(); ++k) {
    const Eigen::Vector3d rest = body->V.row(actor->vertices()[k]).transpose().cast<double>();
    const Eigen::Vector3d now = rest + Eigen::Map<const Eigen::Vector3f>(&frame.displacement[3 * k]).cast<double>();
    for (const Eyeball& eye : actor->face().eyes) {
      if ((rest - eye.centre).norm() < eye.radius || rest.z() < eye.centre.z()) continue;
      EXPECT_GT((now - eye.centre).norm(), eye.radius - 1e-6);
    }
  }
}

TEST_F(Expression, VowelsKeepTheVolumeOfTheFlesh) {
  for (const char* vowel : {"a", "e", "i", "o", "u"}) {
    const Validity validity = actor->validity(drive({vowel}));
    EXPECT_LT(std::abs(validity.volume), 0.02) << vowel;
  }
}

TEST_F(Expression, ClosedLipsStayClosedAndNeverCross) {
  for (const NamedExpression& expression : named_expressions()) {
    const Drive how = drive({expression.name});
    const Frame frame = actor->frame(how, FaceMethod::contact);
    EXPECT_TRUE(frame.converged) << expression.name;
    EXPECT_LT(frame.lip_gap, 2e-5) << expression.name;
  }
  // the lips press on each other for m
  EXPECT_GT(actor->frame(drive({"m"}), FaceMethod::contact).lip_force, 0.01);
}

TEST_F(Expression, NothingIsLargerThanAFaceCanMove) {
  for (const NamedExpression& expression : named_expressions()) {
    const Frame frame = actor->frame(drive({expression.name}), FaceMethod::contact);
    for (float d : frame.displacement) EXPECT_LT(std::abs(d), 0.05f) << expression.name;
  }
}

}  // namespace
}  // namespace face
