#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "manipulators/mesh/figure/arm.h"
#include "manipulators/mesh/figure/landmarks.h"
#include "manipulators/mesh/figure/script.h"
#include "manipulators/mesh/figure/section.h"
#include "manipulators/mesh/figure/solve.h"
#include "manipulators/mesh/read.h"
#include "manipulators/mesh/topology.h"
#include "tests/manipulators/mesh/surfaces.h"

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const char* const body_file = "/usr/share/assimp/models/Collada/human.zae";

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string script(const std::string& name) { return std::string(SOURCE_DIR) + "/scripts/figures/" + name; }

std::string data_folder() {
  const char* folder = std::getenv("SAILOR_DATA");
  return folder != nullptr ? folder : std::string(SOURCE_DIR) + "/../shared/data";
}

/// The body and what is made from it, once for all tests.
struct Sailor {
  mesh::Surface body;
  figure::Landmarks marks;
  figure::Skeleton skeleton;

  static const Sailor* get() {
    static const Sailor* sailor = []() -> const Sailor* {
      const auto body = mesh::read_surface(body_file);
      if (!body) return nullptr;
      const auto marks = figure::find_landmarks(*body);
      const auto neck = figure::read_parts(text_of(script("neck.dlg")));
      if (!marks || !neck) return nullptr;
      return new Sailor{*body, *marks, figure::make_skeleton(*marks, *neck)};
    }();
    return sailor;
  }
};

#define NEEDS_BODY()                                                                         \
  if (!std::filesystem::exists(body_file)) GTEST_SKIP() << body_file << " is not installed"; \
  ASSERT_NE(Sailor::get(), nullptr);                                                         \
  const Sailor& sailor = *Sailor::get()

TEST(Section, OfATubeIsItsCircle) {
  const mesh::Surface tube = known::tube(1, 0.1, 20, 64);
  const auto loops = figure::section(tube, {0, 0.33, 0}, Vector3d::UnitY());
  ASSERT_EQ(loops.size(), 1U);
  // a polygon of 64 sides: short of the circle by (pi/64)^2 of its area, half as much of its perimeter
  EXPECT_NEAR(loops[0].area, M_PI * 0.01, 2e-3 * M_PI * 0.01);
  EXPECT_NEAR(loops[0].perimeter, 2 * M_PI * 0.1, 1e-3);
  EXPECT_LT((loops[0].centroid - Vector3d(0, 0.33, 0)).norm(), 1e-6);
  // an oblique section's centroid stays on the axis
  const auto oblique = figure::section(tube, {0, 0.5, 0}, Vector3d(0, 1, 0.5).normalized());
  ASSERT_EQ(oblique.size(), 1U);
  EXPECT_LT((oblique[0].centroid - Vector3d(0, 0.5, 0)).norm(), 1e-6);
  EXPECT_TRUE(figure::section(tube, {0, 2, 0}, Vector3d::UnitY()).empty());
}

TEST(Axes, DenavitHartenbergTurnsAboutTheGivenLines) {
  // crossing, parallel and skew axes
  const std::vector<figure::Axis> axes = {{{0, 0, 0}, Vector3d::UnitX()},
                                          {{0, 0, 0}, Vector3d::UnitZ()},
                                          {{0.2, 0.5, 0}, Vector3d::UnitZ()},
                                          {{0.2, 0.5, 0.3}, Vector3d(0.1, 0.9, -0.3).normalized()},
                                          {{0.4, -0.2, 0.1}, Vector3d(-0.5, 0.2, 0.7).normalized()}};
  const Isometry3d end = Eigen::Translation3d(0.3, 0.1, -0.4) * Eigen::AngleAxisd(0.6, Vector3d::UnitY());
  const figure::DhChain chain = figure::denavit_hartenberg(axes, end);
  const std::array<double, 5> q = {0.3, -0.8, 1.1, -0.4, 0.9};
  Isometry3d by_table = chain.base;
  Isometry3d by_lines = Isometry3d::Identity();
  for (int i = 0; i < 5; ++i) {
    by_table = by_table * chain.rows[i].transform(q[i]);
    by_lines = by_lines * Eigen::Translation3d(axes[i].point) * Eigen::AngleAxisd(q[i], axes[i].direction) *
               Eigen::Translation3d(-axes[i].point);
  }
  EXPECT_TRUE((by_table * chain.tool).isApprox(by_lines * end, 1e-12));
}

TEST(LeastSquares, FindsTheMinimumOfRosenbrock) {
  const Eigen::VectorXd x = figure::least_squares(
      [](const Eigen::VectorXd& v) { return Eigen::VectorXd(Eigen::Vector2d(1 - v[0], 10 * (v[1] - v[0] * v[0]))); },
      Eigen::Vector2d(-1.2, 1));
  EXPECT_LT((x - Eigen::Vector2d(1, 1)).norm(), 1e-9);
}

TEST(Arm, JointCentresAreTheModelsAtZero) {
  const auto frames = figure::scaled_arm(1, 1, 1).frames({});
  // the model's own numbers: AC 0.2077 out and 0.0282 back of SC, GH from there; four digits
  const Vector3d sc(0.0014, -0.0152, 0.0028);
  EXPECT_LT((frames[figure::Arm::ac_y].translation() - sc - Vector3d(0.2077, 0, 0.0282)).norm(), 2e-4);
  EXPECT_LT((frames[figure::Arm::gh_z].translation() - sc - Vector3d(0.2097, -0.0231, -0.0157)).norm(), 2e-4);
}

TEST(Arm, WristGoesWhereAnotherProgramHasIt) {
  const std::string path = data_folder() + "/arm/das4_fk_mujoco.csv";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << path << " is not there; set SAILOR_DATA to the folder of reference data";
  const figure::Arm arm = figure::scaled_arm(1, 1, 1);
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  double sum = 0, most = 0;
  int rows = 0;
  for (; std::getline(file, line); ++rows) {
    std::istringstream words(line);
    std::array<double, 14> row{};
    for (double& number : row) {
      std::string word;
      std::getline(words, word, ',');
      number = std::atof(word.c_str());
    }
    std::array<double, figure::Arm::joints> q{};
    for (int i = 0; i < figure::Arm::joints; ++i) q[i] = row[i] * M_PI / 180;
    const Vector3d wrist = arm.frames(q).back().translation();
    const double apart = (wrist - Vector3d(row[11], row[12], row[13])).norm();
    sum += apart;
    most = std::max(most, apart);
  }
  ASSERT_GT(rows, 400);
  // the other program has the model's next edition, whose elbow was measured anew (18 degrees of carrying angle at zero
  // against none): the wrists are about 5 cm apart, always; a wrong sign or a swapped axis would make it decimetres,
  // and sometimes nothing
  EXPECT_LT(sum / rows, 0.06);
  EXPECT_LT(most - sum / rows, 0.015);
}

TEST(Arm, RhythmRaisesTheShoulderBladeAsTheRegressionSays) {
  const figure::Arm arm = figure::scaled_arm(1, 1, 1);
  const auto yzx = [](double y, double z, double x) {
    return Eigen::Matrix3d(Eigen::AngleAxisd(y, Vector3d::UnitY()) * Eigen::AngleAxisd(z, Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(x, Vector3d::UnitX()));
  };
  const double degree = M_PI / 180;
  for (double plane : {0.0, 0.6}) {
    for (double elevation : {0.6, 1.2, 1.8}) {
      const auto q = figure::girdle_rhythm(arm, plane, elevation);
      bool free = true;
      for (int i = 0; i < 6; ++i) {
        EXPECT_GE(q[i], arm.lower[i]);
        EXPECT_LE(q[i], arm.upper[i]);
        free = free && q[i] > arm.lower[i] && q[i] < arm.upper[i];
      }
      if (!free) continue;
      // collarbone times blade on it is the blade in the thorax, whose upward rotation is the regression's Sz
      const Eigen::Matrix3d blade = yzx(q[0], q[1], q[2]) * yzx(q[3], q[4], q[5]);
      const double Sz = 3.095 - 0.079 * plane / degree + 0.396 * elevation / degree + 0.414 * 10.669;
      EXPECT_NEAR(std::asin(blade(1, 0)) / degree, Sz, 1e-9);
    }
  }
}

TEST(Landmarks, LieWhereTheMakersOfTheBodyPutItsJoints) {
  NEEDS_BODY();
  const std::string folder = data_folder() + "/head/makehuman/";
  std::ifstream base(folder + "base.obj");
  if (!base) GTEST_SKIP() << folder << "base.obj is not there; set SAILOR_DATA to the folder of reference data";
  // the undeformed model carries a small cube around each joint; it is another person, so only lengths are compared
  std::vector<Vector3d> V;
  std::map<std::string, std::vector<int>> groups;
  std::string line, group;
  while (std::getline(base, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vector3d p;
      words >> p.x() >> p.y() >> p.z();
      V.push_back(0.1 * p);
    } else if (kind == "g") {
      words >> group;
    } else if (kind == "f") {
      for (std::string corner; words >> corner;) groups[group].push_back(std::atoi(corner.c_str()) - 1);
    }
  }
  const auto joint = [&](const std::string& name) {
    Vector3d middle = Vector3d::Zero();
    for (int v : groups.at("joint-" + name)) middle += V[v] / groups.at("joint-" + name).size();
    return middle;
  };
  const auto length = [&](const std::string& a, const std::string& b) { return (joint(a) - joint(b)).norm(); };
  const figure::Landmarks& m = sailor.marks;
  // the body is a smaller person than the undeformed model (its x, y, z are 1.03, 1.00, 1.03 times as large on
  // average): lengths agree to a tenth
  EXPECT_NEAR((m.elbow - m.shoulder).norm(), length("l-elbow", "l-shoulder"), 0.17 * 0.26);
  EXPECT_NEAR((m.knee - m.hip).norm(), length("l-knee", "l-upper-leg"), 0.1 * 0.41);
  EXPECT_NEAR((m.ankle - m.knee).norm(), length("l-ankle", "l-knee"), 0.1 * 0.41);
  EXPECT_NEAR((m.fingertip - m.wrist).norm(), length("l-finger-3-4", "l-hand"), 0.15 * 0.18);
}

TEST(Landmarks, AreThoseOfAPersonOfThatStature) {
  NEEDS_BODY();
  const figure::Landmarks& m = sailor.marks;
  EXPECT_NEAR(m.stature, 1.66, 0.005);
  // Drillis and Contini 1966, fractions of stature; people differ by about a tenth
  EXPECT_NEAR((m.elbow - m.shoulder).norm(), 0.186 * m.stature, 0.19 * 0.186 * m.stature);
  EXPECT_NEAR((m.wrist - m.elbow).norm(), 0.146 * m.stature, 0.1 * 0.146 * m.stature);
  EXPECT_NEAR((m.fingertip - m.wrist).norm(), 0.108 * m.stature, 0.1 * 0.108 * m.stature);
  EXPECT_NEAR(m.eye.y(), 0.936 * m.stature, 0.01 * m.stature);
  // distance between the eyes: 62 mm on average, 54 to 70 (Dodgson 2004, from memory)
  EXPECT_NEAR(2 * m.eye.x(), 0.062, 0.008);
  EXPECT_GT(m.palm.dot(Vector3d(-1, -1, 0).normalized()), 0.8);
}

TEST(Landmarks, AreNotFoundInWhatIsNoBody) {
  const auto marks = figure::find_landmarks(known::cube());
  ASSERT_FALSE(marks);
  EXPECT_EQ(marks.error().kind, "range");
  EXPECT_NE(marks.error().sentence.find("eyeball"), std::string::npos);
}

TEST(Skeleton, StandsInTheBodyAtBindTime) {
  NEEDS_BODY();
  // the leg has six freedoms for seven wishes (knee, ankle, level sole): 15 mm are left at most
  EXPECT_LT(sailor.skeleton.fit_error, 0.015);
  for (const figure::Part& part : sailor.skeleton.parts) {
    EXPECT_GE(part.bind, part.lower - 1e-9) << part.name;
    EXPECT_LE(part.bind, part.upper + 1e-9) << part.name;
    EXPECT_GE(part.stand, part.lower - 1e-9) << part.name;
    EXPECT_LE(part.stand, part.upper + 1e-9) << part.name;
    EXPECT_GE(part.rest, part.lower - 1e-9) << part.name;
    EXPECT_LE(part.rest, part.upper + 1e-9) << part.name;
  }
  // segments run inside the skin: seen from their middle the surface is crossed an odd number of times on every way out
  const mesh::Surface skin = [&] {
    std::vector<bool> keep;
    for (int part : sailor.body.part) keep.push_back(sailor.body.part_names[part].find("eye") == std::string::npos);
    return mesh::subset(sailor.body, keep);
  }();
  for (const figure::Segment& segment : sailor.skeleton.segments) {
    const Vector3d middle = segment.bind * Vector3d(0.5 * (segment.from + segment.to));
    const auto loops = figure::section(skin, middle, Vector3d::UnitY());
    bool inside = false;
    for (const figure::Loop& loop : loops) {
      bool odd = false;
      for (std::size_t i = 0; i < loop.points.size(); ++i) {
        const Vector3d& p = loop.points[i];
        const Vector3d& q = loop.points[(i + 1) % loop.points.size()];
        if ((p.z() > middle.z()) != (q.z() > middle.z()) &&
            middle.x() < p.x() + (middle.z() - p.z()) / (q.z() - p.z()) * (q.x() - p.x())) {
          odd = !odd;
        }
      }
      inside = inside || odd;
    }
    EXPECT_TRUE(inside) << segment.name;
  }
}

TEST(Skeleton, LeftIsTheMirrorImageOfRight) {
  NEEDS_BODY();
  // any posture, the same on both sides
  int turn = 0;
  std::map<std::string, double> chosen;
  const auto angle = [&](const figure::Part& part) {
    const bool sided = part.name.rfind("left_", 0) == 0 || part.name.rfind("right_", 0) == 0;
    if (!sided) return 0.0;
    const std::string key = part.name.substr(part.name.find('_'));
    const auto [found, is_new] = chosen.try_emplace(key, 0.0);
    if (is_new) found->second = part.lower + (0.1 + 0.8 * ((turn++ * 37) % 100) / 100.0) * (part.upper - part.lower);
    return found->second;
  };
  const auto X = figure::frames(sailor.skeleton, angle);
  for (const char* name : {"hand", "fingertip", "wrist", "foot", "toes", "el_x", "knee_flexion"}) {
    const Vector3d left = X.at(std::string("left_") + name).translation();
    const Vector3d right = X.at(std::string("right_") + name).translation();
    EXPECT_LT((left - Vector3d(-right.x(), right.y(), right.z())).norm(), 1e-9) << name;
  }
  for (const char* name : {"left_hand", "left_foot"}) {
    EXPECT_NEAR(X.at(name).linear().determinant(), 1, 1e-9) << name;
  }
}

TEST(Skeleton, AnglesTurnLimbsTheWayTheirNamesSay) {
  NEEDS_BODY();
  const auto with = [&](const std::string& joint, double value) {
    return figure::frames(sailor.skeleton, [&](const figure::Part& p) { return p.name == joint ? value : p.stand; });
  };
  const auto stand = figure::frames(sailor.skeleton, [](const figure::Part& p) { return p.stand; });
  for (const std::string side : {"right_", "left_"}) {
    const double out = side == "left_" ? 1 : -1;
    const std::string foot = side + "foot";
    EXPECT_GT(with(side + "hip_flexion", 1).at(foot).translation().z(), stand.at(foot).translation().z() + 0.3);
    EXPECT_GT(out * with(side + "hip_abduction", 0.6).at(foot).translation().x(), 0.3);
    EXPECT_LT(with(side + "knee_flexion", 1).at(foot).translation().z(), stand.at(foot).translation().z() - 0.3);
    EXPECT_GT(with(side + "ankle_flexion", 0.3).at(foot).translation().y(), stand.at(foot).translation().y() + 0.01);
    EXPECT_GT(with(side + "el_x", 1.5).at(side + "hand").translation().y(),
              stand.at(side + "hand").translation().y() + 0.2);
  }
  EXPECT_GT(with("l3_l4_flexion", 0.4).at("head").translation().z(), stand.at("head").translation().z() + 0.1);
  // the soles stand on the ground
  EXPECT_NEAR(stand.at("right_foot").translation().y(), sailor.marks.ball.y() + figure::sole(sailor.marks), 1e-6);
}

TEST(Skin, FollowsTheRightBones) {
  NEEDS_BODY();
  const auto skin = mesh::bind_skin(sailor.body, figure::bones(sailor.skeleton));
  ASSERT_TRUE(skin) << skin.error().sentence;
  const auto strongest = [&](const Vector3d& place) {
    Eigen::Index nearest = 0;
    (skin->surface.V.rowwise() - place.transpose().cast<float>()).rowwise().squaredNorm().minCoeff(&nearest);
    return skin->bones[skin->index(nearest, 0)].name;
  };
  const figure::Landmarks& m = sailor.marks;
  EXPECT_EQ(strongest(m.fingertip), "left_hand");
  EXPECT_EQ(strongest(m.toe), "left_big_toe");
  EXPECT_EQ(strongest({0, m.stature, 0.04}), "head");
  EXPECT_EQ(strongest(0.5 * (m.knee + m.ankle)), "left_shin");
  EXPECT_EQ(strongest({0, 1.06, 0.15}), "lumbar_upper");
  // lips, chin and nose go with the skull
  for (const Vector3d& place : {Vector3d(0, 1.460, 0.142), Vector3d(0, 1.481, 0.150), Vector3d(0.023, 1.488, 0.140),
                                Vector3d(0, 1.518, 0.160)}) {
    Eigen::Index nearest = 0;
    (skin->surface.V.rowwise() - place.transpose().cast<float>()).rowwise().squaredNorm().minCoeff(&nearest);
    double others = 0;
    for (int i = 0; i < mesh::Skin::influences; ++i) {
      const std::string& name = skin->bones[skin->index(nearest, i)].name;
      if (name != "head" && !name.ends_with("jaw")) others += skin->weight(nearest, i);
    }
    EXPECT_LT(others, 0.05) << place.transpose();
  }
  // nothing of the arm in the waist, nothing of one leg in the other
  for (Eigen::Index v = 0; v < skin->surface.V.rows(); ++v) {
    const Vector3d p = skin->surface.V.row(v).transpose().cast<double>();
    for (int i = 0; i < mesh::Skin::influences && skin->weight(v, i) > 0; ++i) {
      const std::string& name = skin->bones[skin->index(v, i)].name;
      const bool left = name.rfind("left_", 0) == 0;
      // the armpit is at 0.74 of the stature
      if (name.find("humerus") != std::string::npos && std::abs(p.x()) < 0.14) {
        EXPECT_LT(skin->weight(v, i), p.y() < 0.65 * m.stature   ? 0.02
                                      : p.y() < 0.70 * m.stature ? 0.08
                                                                 : 1.0F)
            << p.transpose();
      }
      if (p.y() < 0.4 * m.stature && left) {
        EXPECT_GT(p.x(), 0) << name;
      }
    }
  }
}

TEST(Skin, BendsWithoutTearingOrCollapsing) {
  NEEDS_BODY();
  const auto skin = mesh::bind_skin(sailor.body, figure::bones(sailor.skeleton));
  ASSERT_TRUE(skin);
  const auto area_and_volume = [&](const std::map<std::string, double>& posture) {
    const auto pose = figure::bone_pose(sailor.skeleton, [&](const figure::Part& p) {
      const auto found = posture.find(p.name);
      return found == posture.end() ? p.bind : found->second;
    });
    mesh::Surface moved = skin->surface;
    Eigen::MatrixX3f N;
    mesh::deform(*skin, pose, moved.V, N);
    EXPECT_TRUE(moved.V.allFinite());
    const mesh::Topology t = mesh::topology(moved);
    return std::pair(t.area, t.volume);
  };
  const auto [area, volume] = area_and_volume({});
  const std::map<std::string, double> postures[] = {{{"right_el_x", 2.3}},
                                                    {{"right_ps_y", 0.1}},
                                                    {{"right_ps_y", 2.7}},
                                                    {{"right_gh_z", 1.2}, {"right_gh_y", 0.0}, {"right_gh_yy", 0.0}},
                                                    {{"right_knee_flexion", 2.0}, {"right_hip_flexion", 1.5}}};
  for (const auto& posture : postures) {
    const auto [bent_area, bent_volume] = area_and_volume(posture);
    // skin stretches and folds near the joint only: the body changes by less than a twentieth
    EXPECT_NEAR(bent_area, area, 0.05 * area) << posture.begin()->first;
    EXPECT_NEAR(bent_volume, volume, 0.05 * volume) << posture.begin()->first;
  }
}

TEST(Uniform, CapAndShoesAreClosedAndShoesHoldTheFeet) {
  NEEDS_BODY();
  for (const mesh::Surface& worn : {figure::cap(sailor.marks), figure::shoe(sailor.body, sailor.marks),
                                    figure::mirror_image(figure::shoe(sailor.body, sailor.marks))}) {
    const mesh::Topology t = mesh::topology(worn);
    EXPECT_TRUE(t.closed());
    EXPECT_TRUE(t.manifold());
    EXPECT_GT(t.volume, 0);
    EXPECT_EQ(t.euler, 2);
  }
}

TEST(Scripts, AreNotStale) {
  NEEDS_BODY();
  // made anew from the body they read as they lie in the tree; after a change run scripts/figures/make
  EXPECT_EQ(figure::skeleton_script(sailor.skeleton, sailor.marks), text_of(script("skeleton.dlg")));
  EXPECT_EQ(figure::body_script(sailor.skeleton, sailor.marks, body_file), text_of(script("body.dlg")));
  EXPECT_EQ(figure::gaze_script(sailor.marks), text_of(script("gaze.dlg")));
}

/// What a shell command prints.
std::string output_of(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  std::string printed;
  for (char buffer[4096]; const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe);) printed.append(buffer, n);
  return pclose(pipe) == 0 ? printed : "failed: " + printed;
}

TEST(Scripts, NeckIsWhatHeadIkPrints) {
  const std::string program = std::string(BIN_DIR) + "/head_ik";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "head_ik has not been built beside this test";
  std::istringstream neck(text_of(script("neck.dlg")));
  std::string first;
  std::getline(neck, first);
  const std::string options = first.substr(first.find("--figure-neck"));
  const std::string printed = output_of(program + " " + options);
  EXPECT_EQ(first + "\n" + printed, text_of(script("neck.dlg")));
}

TEST(Scripts, BuildTheSkeletonInTheWorldThatWasMeant) {
  NEEDS_BODY();
  const std::string manager = std::string(BIN_DIR) + "/dialog_manager";
  if (!std::filesystem::exists(manager)) GTEST_SKIP() << "dialog_manager has not been built beside this test";
  // the world's own scene graph is the witness; numbers in the scripts have nine decimals, added up along a chain
  const auto X = figure::frames(sailor.skeleton, [](const figure::Part& part) { return part.stand; });
  const char* names[] = {"head", "right_hand", "left_fingertip", "right_foot", "left_toes", "left_eye_socket"};
  std::string command = manager + " -c 'source " + script("skeleton.dlg") + " under crew/mate'";
  command.insert(manager.size(), " -c 'create node crew position 1 2 3'");
  for (const char* name : names) command += std::string(" -c 'get crew/mate/") + name + ".world_position'";
  std::istringstream printed(output_of(command));
  for (const char* name : names) {
    Vector3d p = Vector3d::Zero();
    printed >> p.x() >> p.y() >> p.z();
    EXPECT_LT((p - Vector3d(1, 2, 3) - X.at(name).translation()).norm(), 1e-7) << name;
  }
}

TEST(Scripts, NumbersAreShortAndNeverMinusZero) {
  EXPECT_EQ(figure::number(0.5), "0.5");
  EXPECT_EQ(figure::number(-1e-15), "0");
  EXPECT_EQ(figure::number(120), "120");
  EXPECT_EQ(figure::number(-0.1234567891234), "-0.123456789");
}

TEST(Scripts, ABrokenNeckIsRefused) {
  EXPECT_FALSE(figure::read_parts("create joint a parent"));
  EXPECT_FALSE(figure::read_parts("create joint a dh 1 2 3"));
  EXPECT_FALSE(figure::read_parts("make joint a"));
  EXPECT_FALSE(figure::read_parts("create joint a color 1 1 1"));
  ASSERT_TRUE(figure::read_parts("# nothing\n"));
}

}  // namespace
