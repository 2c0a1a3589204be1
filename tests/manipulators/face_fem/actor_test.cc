#include "manipulators/face_fem/actor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/manipulators/face_fem/toy_face.h"

namespace face {
namespace {

std::unique_ptr<Actor> toy_actor() {
  auto actor = Actor::make(toy_face());
  EXPECT_TRUE(actor.ok()) << actor.error().sentence;
  return std::move(*actor);
}

Drive still(const Actor& actor) {
  Drive drive;
  drive.activation.assign(std::size_t(actor.muscles()), 0.0);
  return drive;
}

double gap(const Actor& actor, const Field& u, std::size_t pair) {
  const SlitPair& p = actor.face().lips.pairs[pair];
  return p.normal.dot(u.col(p.upper) - u.col(p.lower));
}

double largest_difference(const Frame& a, const Frame& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.displacement.size(); ++k)
    largest = std::max(largest, std::abs(double(a.displacement[k]) - double(b.displacement[k])));
  return largest;
}

TEST(Actor, AtRestNothingMoves) {
  const auto actor = toy_actor();
  for (const FaceMethod method : {FaceMethod::basis, FaceMethod::contact, FaceMethod::solve})
    for (float d : actor->frame(still(*actor), method).displacement) EXPECT_EQ(d, 0);
}

TEST(Actor, SumsAreTheFullSolve) {
  const auto actor = toy_actor();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> level(0, 1);
  for (int k = 0; k < 5; ++k) {
    Drive drive = still(*actor);
    for (double& a : drive.activation) a = level(random);
    drive.jaw = 0.2 * level(random);
    drive.thrust = 0.004 * level(random);
    drive.part = level(random);
    const Frame sums = actor->frame(drive, FaceMethod::contact), solved = actor->frame(drive, FaceMethod::solve);
    // single precision sums of columns: 1e-7 of centimetres
    EXPECT_LT(largest_difference(sums, solved), 2e-8);
    EXPECT_TRUE(sums.converged);
  }
}

TEST(Actor, TheJawGoesRoundItsHinge) {
  const auto actor = toy_actor();
  Drive drive = still(*actor);
  drive.jaw = 0.2;
  drive.part = 1;
  const Field u = actor->field(drive);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (const Support& support : actor->face().model.supports) {
    const Eigen::Vector3d r = actor->face().model.nodes[std::size_t(support.node)] - actor->face().jaw.centre;
    const Eigen::Vector3d expected = support.bone == 1 ? Eigen::Vector3d(R * r - r) : Eigen::Vector3d(0, 0, 0);
    EXPECT_LT((u.col(support.node) - expected).norm(), 1e-15);
  }
  const Frame frame = actor->frame(drive, FaceMethod::contact);
  EXPECT_STREQ(frame.validity.word(), frame.validity.inverted > 0 ? "inverted" : "bone_turn");
  drive.jaw = 0.01;
  EXPECT_STREQ(actor->frame(drive, FaceMethod::contact).validity.word(), "ok");
}

TEST(Actor, LipsDoNotPassThroughEachOther) {
  const auto actor = toy_actor();
  Drive drive = still(*actor);
  // the chin is raised: the lower lip comes up
  drive.activation.back() = 1;
  drive.part = 1;
  const Field free = actor->field(drive, FaceMethod::basis), kept = actor->field(drive, FaceMethod::contact);
  double deepest = 0;
  for (std::size_t p = 0; p < actor->face().lips.pairs.size(); ++p) {
    deepest = std::min(deepest, gap(*actor, free, p));
    EXPECT_GT(gap(*actor, kept, p), -2e-6) << p;
  }
  EXPECT_LT(deepest, -2e-4);
  const Frame frame = actor->frame(drive, FaceMethod::contact);
  EXPECT_GT(frame.lip_force, 0.01);
  EXPECT_LT(frame.lip_gap, 2e-6);
}

TEST(Actor, SealedLipsStayShutUntilTheyPart) {
  const auto actor = toy_actor();
  Drive drive = still(*actor);
  drive.activation[2] = drive.activation[3] = 0.1;
  const auto widest = [&] {
    const Field u = actor->field(drive);
    double most = 0;
    for (std::size_t p = 0; p < actor->face().lips.pairs.size(); ++p) most = std::max(most, gap(*actor, u, p));
    return most;
  };
  EXPECT_LT(widest(), 2e-6);
  drive.part = 1;
  EXPECT_GT(widest(), 5e-5);
  drive.activation[2] = drive.activation[3] = 1;
  drive.part = 0;
  EXPECT_GT(widest(), 5e-4) << "a strong pull opens sealed lips";
}

TEST(Actor, TheContactIsTheMinimumOfItsProblem) {
  Face face = toy_face();
  std::vector<bool> held(face.model.nodes.size(), false);
  for (const Support& support : face.model.supports) held[std::size_t(support.node)] = true;
  auto statics = Statics::make(face.model);
  ASSERT_TRUE(statics.ok());
  Basis basis(*statics, skin_nodes(face.model));
  const ElementBoxes boxes(face.model);
  for (const Muscle& muscle : face.muscles) basis.add({load_of(face.model, boxes, muscle)->load});
  const LipContact lips(face.model, face.lips, held, basis);
  const double tone = 0.01;
  std::vector<double> amounts(std::size_t(basis.columns()), 0.0);
  amounts[2] = 0.8;
  amounts[4] = 0.6;
  const auto answer = lips.solve(amounts.data(), tone);
  ASSERT_TRUE(answer.converged);
  for (int i = 0; i < lips.pairs(); ++i) amounts[std::size_t(lips.first_column() + i)] = answer.force[i];
  const Field u = basis.field(amounts.data());
  int open = 0, pressed = 0, k = 0;
  for (const SlitPair& pair : face.lips.pairs) {
    if (held[std::size_t(pair.upper)]) continue;
    const double width = pair.normal.dot(u.col(pair.upper) - u.col(pair.lower)), force = answer.force[k++];
    EXPECT_GE(force, -tone);
    EXPECT_GT(width, -2e-6);
    // where it is open the seal pulls with all it has; elsewhere it is shut
    if (force > -tone) {
      EXPECT_LT(width, 2e-6);
    }
    open += width > 1e-5;
    pressed += force > 0;
  }
  EXPECT_GT(open, 0);
  EXPECT_GT(pressed, 0);
}

TEST(Actor, ADraggedMuscleIsAsIfBuiltThere) {
  const auto actor = toy_actor();
  Muscle moved = actor->muscle(0);
  moved.strands[0].insertion.y() += 0.005;
  ASSERT_TRUE(actor->set_muscle(0, moved).ok());
  Muscle more = moved;
  more.name = "another";
  more.strands[0].insertion.x() = 0.002;
  ASSERT_TRUE(actor->set_muscle(actor->muscles(), more).ok());
  Face face = toy_face();
  face.muscles[0] = moved;
  face.muscles.push_back(more);
  const auto fresh = Actor::make(std::move(face));
  ASSERT_TRUE(fresh.ok());
  Drive drive = still(*actor);
  drive.activation[0] = 1;
  drive.activation[5] = 0.7;
  drive.activation[4] = 0.5;
  EXPECT_LT(largest_difference(actor->frame(drive, FaceMethod::contact), (*fresh)->frame(drive, FaceMethod::contact)),
            1e-8);
  Muscle lost = moved;
  lost.strands[0].insertion.z() = 1;
  const auto refused = actor->set_muscle(0, lost);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().fault, Fault::missed_sphere);
  EXPECT_EQ(actor->muscle(0).strands[0].insertion, moved.strands[0].insertion);
}

TEST(Actor, StrainAtTheMiddlesIsThatOfTheWholeMeasure) {
  const auto actor = toy_actor();
  const Model& model = actor->face().model;
  // a uniform gradient is the same at middles, points and corners
  Eigen::Matrix3d H;
  H << 0.02, 0.1, 0, -0.03, 0.05, 0.01, 0.2, 0, -0.08;
  Field u(3, Eigen::Index(model.nodes.size()));
  for (std::size_t n = 0; n < model.nodes.size(); ++n) u.col(Eigen::Index(n)) = H * model.nodes[n];
  StrainWatch watch(model);
  watch.read(model, u, 0);
  const Validity whole = validity_of(model, u), middles = watch.measure({1.0});
  EXPECT_NEAR(middles.strain, whole.strain, 1e-6);
  EXPECT_EQ(middles.inverted, 0);
  // pushed through itself along x
  Field through = Field::Zero(3, u.cols());
  for (std::size_t n = 0; n < model.nodes.size(); ++n) through(0, Eigen::Index(n)) = -1.5 * model.nodes[n].x();
  watch.read(model, through, 1);
  const Validity inside_out = watch.measure({0.0, 1.0});
  EXPECT_EQ(inside_out.inverted, int(model.hexahedra.size()));
}

TEST(Driver, SidesActAloneAndNothingPassesOne) {
  const std::vector<std::string> names = {"left_zygomaticus_major", "right_zygomaticus_major", "procerus",
                                          "left_depressor_supercilii"};
  const Driver driver(names);
  EXPECT_FALSE(driver.missing().empty());
  Levels levels{};
  levels[std::size_t((*places_of("AU12L"))[0])] = 1;
  Drive drive = driver.drive(levels, {}, {});
  EXPECT_EQ(drive.activation[0], 1);
  EXPECT_EQ(drive.activation[1], 0);
  levels.fill(1);
  drive = driver.drive(levels, {}, {});
  for (double a : drive.activation) {
    EXPECT_GE(a, 0);
    EXPECT_LE(a, 1);
  }
  EXPECT_LE(drive.jaw, Habits().widest_jaw);
}

TEST(Driver, LidsNeverCrossAndABlinkShuts) {
  const Driver driver({});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> level(0, 1), elevation(-0.8, 0.8);
  for (int k = 0; k < 2000; ++k) {
    Levels levels{};
    for (double& l : levels) l = level(random);
    Eyes eyes;
    eyes.elevation = {elevation(random), elevation(random)};
    eyes.blink = {level(random), 1};
    const Drive drive = driver.drive(levels, eyes, {});
    EXPECT_LE(drive.lids[0].upper + drive.lids[0].lower, 1 + 1e-12);
    EXPECT_NEAR(drive.lids[1].upper + drive.lids[1].lower, 1, 1e-12);
  }
  Eyes down, up;
  down.elevation = {-0.3, -0.3};
  up.elevation = {0.3, 0.3};
  EXPECT_GT(driver.drive({}, down, {}).lids[0].upper, 0.2);
  EXPECT_LT(driver.drive({}, up, {}).lids[0].upper, -0.2);
}

// an eye's opening on a ball of 12 mm, 13 mm high in the middle
struct Opening {
  Model model;
  Slit slit;
  Eyeball eye{{0.03, 0.02, 0.05}, 0.012};

  Opening() {
    slit.columns = 7;
    slit.levels = 2;
    for (int c = 0; c < 7; ++c)
      for (int level = 0; level < 2; ++level) {
        const double x = 0.010 * (c - 3) / 3.0, half = 0.5 * (1 - std::pow((c - 3) / 4.0, 2));
        const double r = std::sqrt(std::pow(0.0125 + 0.002 * level, 2) - x * x);
        for (double sign : {1.0, -0.7})
          model.nodes.push_back(eye.centre + Eigen::Vector3d(x, r * std::sin(sign * half), r * std::cos(sign * half)));
        const int n = int(model.nodes.size());
        slit.pairs.push_back({n - 2, n - 1, c, level, Eigen::Vector3d::UnitY()});
      }
  }
};

TEST(LidPath, ClosesAlongTheEyeball) {
  const Opening o;
  const LidPath path(o.model, o.slit, o.eye, Eigen::Vector3d::UnitX(), std::vector<bool>(o.model.nodes.size(), false));
  EXPECT_NEAR(path.aperture(), 0.85, 1e-3);
  for (double c : {0.0, 0.3, 0.88, 1.0}) {
    const Eigen::Matrix3Xd upper = path.shift(0, c), lower = path.shift(1, 1 - c);
    for (Eigen::Index k = 0; k < upper.cols(); ++k) {
      const Eigen::Vector3d u = o.model.nodes[std::size_t(path.nodes(0)[std::size_t(k)])] + upper.col(k);
      const Eigen::Vector3d l = o.model.nodes[std::size_t(path.nodes(1)[std::size_t(k)])] + lower.col(k);
      EXPECT_LT((u - l).norm(), 1e-15);
      EXPECT_GT((u - o.eye.centre).norm(), o.eye.radius);
    }
  }
  // the chord of a straight way would cut a millimetre into the eye
  const Eigen::Vector3d half = 0.5 * (path.shift(0, 1).col(6)), arc = path.shift(0, 0.5).col(6);
  EXPECT_GT((half - arc).norm(), 5e-4);
}

TEST(LidPath, PolynomialsFollowTheWay) {
  const Opening o;
  const LidPath path(o.model, o.slit, o.eye, Eigen::Vector3d::UnitX(), std::vector<bool>(o.model.nodes.size(), false));
  for (int lid : {0, 1}) {
    const auto& samples = lid == 0 ? LidPath::upper_samples : LidPath::lower_samples;
    for (double c = samples.front(); c <= samples.back(); c += 0.01) {
      const auto weights = LidPath::weights(lid, c);
      Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, path.shift(lid, c).cols());
      for (std::size_t k = 0; k < samples.size(); ++k) sum += weights[k] * path.shift(lid, samples[k]);
      EXPECT_LT((sum - path.shift(lid, c)).colwise().norm().maxCoeff(), 1e-5) << lid << " " << c;
    }
    EXPECT_EQ(LidPath::weights(lid, 0), (std::array<double, LidPath::samples>{}));
  }
}

}  // namespace
}  // namespace face
