#include "manipulators/kinematics/chain.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "manipulators/kinematics/arm11.h"
#include "manipulators/kinematics/chain_file.h"
#include "manipulators/kinematics/table.h"

namespace kinematics {
namespace {

constexpr double pi = std::numbers::pi;

std::string data_folder() {
  const char* set = std::getenv("SAILOR_DATA");
  return set ? set : std::string(SOURCE_DIR) + "/../shared/data";
}

std::vector<double> random_posture(const Chain& chain, std::mt19937_64& random) {
  std::vector<double> q;
  for (const Joint& joint : chain.joints) q.push_back(std::uniform_real_distribution(joint.lower, joint.upper)(random));
  return q;
}

double difference(const Pose& a, const Pose& b) {
  return std::max((a.R - b.R).cwiseAbs().maxCoeff(), (a.p - b.p).cwiseAbs().maxCoeff());
}

// a chain with every kind of step: parallel axes, a slide, a skew axis, a transform at either end
Chain mixed() {
  ChainBuilder builder("mixed");
  builder.fix({rotation_y(0.3), {0.1, -0.2, 0.3}});
  builder.joint("a", JointKind::turn, {0, 0, 1}, -2, 2, 0).fix({Eigen::Matrix3d::Identity(), {0.4, 0.1, -0.2}});
  builder.joint("b", JointKind::turn, {0, 0, 1}, -2, 2, 0).fix({rotation_x(1e-9), {0.3, 0, 0.05}});
  builder.joint("c", JointKind::slide, {1, 0, 0}, -0.2, 0.3, 0).fix({rotation_z(0.7), {0, 0.2, 0}});
  builder.joint("d", JointKind::turn, Eigen::Vector3d(1, -2, 0.5).normalized(), -2, 2, 0);
  builder.fix({rotation_about(Eigen::Vector3d(1, 1, 1).normalized(), 2), {0.05, 0.02, 0.01}});
  return builder.finish();
}

TEST(Pose, LogarithmIsExactFromZeroToHalfTurn) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (double angle : {0.0, 1e-12, 1e-9, 1e-4, 0.5, 1.5, 3.0, pi - 1e-4, pi - 1e-9}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      const Eigen::Vector3d back = rotation_vector(rotation_about(axis, angle));
      // a few rounding errors of the entries of a rotation matrix
      EXPECT_LT((back - angle * axis).norm(), 4e-15) << "angle " << angle;
    }
  }
}

TEST(Chain, StepsOfTheBuilderMatchTheirPlainProduct) {
  const Chain chain = mixed();
  const std::vector<double> q = {0.5, -1.1, 0.12, 0.8};
  Pose X{rotation_y(0.3), {0.1, -0.2, 0.3}};
  X = X * Pose{rotation_z(q[0]), {0, 0, 0}} * Pose{Eigen::Matrix3d::Identity(), {0.4, 0.1, -0.2}};
  X = X * Pose{rotation_z(q[1]), {0, 0, 0}} * Pose{rotation_x(1e-9), {0.3, 0, 0.05}};
  X = X * Pose{Eigen::Matrix3d::Identity(), {q[2], 0, 0}} * Pose{rotation_z(0.7), {0, 0.2, 0}};
  X = X * Pose{rotation_about(Eigen::Vector3d(1, -2, 0.5).normalized(), q[3]), {0, 0, 0}};
  X = X * Pose{rotation_about(Eigen::Vector3d(1, 1, 1).normalized(), 2), {0.05, 0.02, 0.01}};
  EXPECT_LT(difference(forward(chain, q), X), 4e-16 * 8);
}

TEST(Chain, JacobianMatchesCentralDifferences) {
  std::mt19937_64 random(2);
  for (const Chain& chain : {arm11(), arm11(Side::left), mixed()}) {
    for (int sample = 0; sample < 20; ++sample) {
      std::vector<double> q = random_posture(chain, random);
      const auto J = jacobian(chain, q);
      for (int i = 0; i < chain.size(); ++i) {
        // central differences: truncation h^2/6 = 2e-11, rounding 1e-16 / h = 1e-11
        const double h = 1e-5, at = q[i];
        q[i] = at + h;
        const Pose after = forward(chain, q);
        q[i] = at - h;
        const Pose before = forward(chain, q);
        q[i] = at;
        EXPECT_LT((J.col(i).head<3>() - (after.p - before.p) / (2 * h)).norm(), 1e-9);
        const Eigen::Vector3d turn = rotation_vector(after.R * before.R.transpose());
        EXPECT_LT((J.col(i).tail<3>() - turn / (2 * h)).norm(), 1e-9);
      }
    }
  }
}

TEST(Chain, LeftArmIsTheMirrorImageOfTheRight) {
  std::mt19937_64 random(3);
  const Chain right = arm11(Side::right), left = arm11(Side::left);
  const Eigen::DiagonalMatrix<double, 3> M(-1, 1, 1);
  for (int sample = 0; sample < 100; ++sample) {
    const std::vector<double> q = random_posture(right, random);
    const Pose a = forward(right, q), b = forward(left, q);
    EXPECT_LT(difference(b, {M * a.R * M, M * a.p}), 2e-15);
  }
}

TEST(Chain, ScalingScalesPositionsAndKeepsOrientations) {
  std::mt19937_64 random(4);
  const Chain chain = mixed(), twice = scaled(chain, 2);
  std::vector<double> q = random_posture(chain, random);
  const Pose small = forward(chain, q);
  q[2] *= 2;  // a slide is a length
  const Pose large = forward(twice, q);
  EXPECT_LT(difference(large, {small.R, 2 * small.p}), 1e-15);
}

// DAS3 names its joints by the thorax axis that each turns about when all are zero; the forearm axes are skew
TEST(Arm11, AxesAtZeroAreTheOnesTheJointsAreNamedAfter) {
  const std::vector<Pose> X = frames(arm11(), std::vector<double>(11, 0.0));
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const std::array<Eigen::Vector3d, 9> expected = {y, z, x, y, z, x, y, z, y};
  for (int i = 0; i < 9; ++i) EXPECT_LT((X[i].R.col(2) - expected[i]).norm(), 1e-15) << arm11_names[i];
  // joint centres: sums of the model's offsets, parallel frames
  EXPECT_LT((X[3].p - Eigen::Vector3d(0.2091, -0.0152, 0.0310)).norm(), 1e-15);
  EXPECT_LT((X[8].p - Eigen::Vector3d(0.2111, -0.0383, -0.0129)).norm(), 1e-15);
}

TEST(Arm11, RestIsWithinLimits) {
  for (const Joint& joint : arm11().joints) {
    EXPECT_GE(joint.rest, joint.lower) << joint.name;
    EXPECT_LE(joint.rest, joint.upper) << joint.name;
  }
}

// 500 poses computed by MuJoCo from the axis lines of the DAS4 arm
TEST(Forward, AgreesWithMujocoOnTheDas4Arm) {
  const std::string folder = data_folder() + "/arm/";
  if (!std::filesystem::exists(folder + "das4_chain.csv")) GTEST_SKIP() << "no reference data at " << folder;
  const auto axes = read_table(folder + "das4_chain.csv");
  const auto poses = read_table(folder + "das4_fk_mujoco.csv");
  ASSERT_TRUE(axes.ok() && poses.ok());
  const auto at = [](const Row& row, int i) { return std::stod(row.cells[i].text); };
  ChainBuilder builder("das4");
  for (const Row& row : axes->rows) {
    builder.fix({Eigen::Matrix3d::Identity(), {at(row, 4), at(row, 5), at(row, 6)}});
    builder.joint(row.cells[1].text, JointKind::turn, {at(row, 7), at(row, 8), at(row, 9)}, -4, 4, 0);
  }
  builder.fix({Eigen::Matrix3d::Identity(), {0.025, -0.242, -0.018}});  // the site named wrist
  const Chain chain = builder.finish();
  ASSERT_EQ(chain.size(), 11);
  ASSERT_EQ(poses->rows.size(), 500u);
  double worst = 0;
  for (const Row& row : poses->rows) {
    std::vector<double> q;
    for (int i = 0; i < 11; ++i) q.push_back(at(row, i) * pi / 180);
    Pose X;
    X.p = {at(row, 11), at(row, 12), at(row, 13)};
    for (int i = 0; i < 9; ++i) X.R(i / 3, i % 3) = at(row, 14 + i);
    worst = std::max(worst, difference(forward(chain, q), X));
  }
  // the model that MuJoCo read writes its skew axes with 8 decimals
  EXPECT_LT(worst, 1e-8);
}

class ChainFile : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    file_ = ::testing::TempDir() + "chain_file_test.csv";
    std::ofstream(file_) << text;
    return file_;
  }
  void TearDown() override { std::filesystem::remove(file_); }
  std::string fault_of(const std::string& text) {
    const auto chain = read_dh_chain(write(text));
    return chain ? "no fault" : chain.error().sentence.substr(file_.size());
  }
  std::string file_;
};

const std::string header = "joint,theta0_deg,d_m,a_m,alpha_deg,lower_deg,upper_deg,rest_deg\n";

TEST_F(ChainFile, ReadsBaseJointsAndTool) {
  const auto chain = read_dh_chain(write(
      header +
      "# a comment\nbase,1,0,0,0.1,0,0,1,0.2,0,-1,0,0.3\nj1,90,0.5,0,-90,-170,170,0\r\n\nj2, 0 ,0,0.25,0,0,90,10\n"
      "tool,1,0,0,0,0,1,0,0,0,0,1,0.1\n"));
  ASSERT_TRUE(chain.ok()) << chain.error().sentence;
  ASSERT_EQ(chain->size(), 2);
  EXPECT_DOUBLE_EQ(chain->joints[0].lower, -170 * pi / 180);
  EXPECT_DOUBLE_EQ(chain->joints[1].rest, 10 * pi / 180);
  // closed form: base * Rz(90) Tz(.5) Rx(-90) * Rz(10) Tx(.25) * Tz(.1)
  const Pose X = Pose{rotation_x(-pi / 2), {0.1, 0.2, 0.3}} *
                 Pose{rotation_z(pi / 2) * rotation_x(-pi / 2), {0, 0, 0.5}} * Pose{rotation_z(pi / 18), {0, 0, 0}} *
                 Pose{Eigen::Matrix3d::Identity(), {0.25, 0, 0.1}};
  EXPECT_LT(difference(forward(*chain, std::vector<double>{0, pi / 18}), X), 1e-15);
}

TEST_F(ChainFile, RefusesBadTablesAtTheirPlace) {
  EXPECT_EQ(fault_of(""), ":1:1: error syntax the file is empty, expected a header line");
  EXPECT_EQ(fault_of("joint,theta\n"), ":1:7: error syntax header column 2 is \"theta\", expected theta0_deg");
  EXPECT_EQ(fault_of(header), ":1:1: error syntax the table has no joints, expected at least one");
  EXPECT_EQ(fault_of(header + "j1,0,x,0,0,-1,1,0\n"), ":2:6: error syntax d_m of \"j1\" is \"x\", expected a number");
  EXPECT_EQ(fault_of(header + "j1,0,nan,0,0,-1,1,0\n"),
            ":2:6: error range d_m of \"j1\" is nan, expected a finite number");
  EXPECT_EQ(fault_of(header + "j1,0,0,0,0,-1,1\n"), ":2:1: error syntax joint \"j1\" has 7 cells, expected 8");
  EXPECT_EQ(fault_of(header + "j1,0,0,0,0,2,1,0\n"),
            ":2:12: error range lower_deg of \"j1\" is 2, expected at most upper_deg 1");
  EXPECT_EQ(fault_of(header + "j1,0,0,0,0,-1,1,5\n"),
            ":2:17: error range rest_deg of \"j1\" is 5, expected within its limits -1 .. 1");
  EXPECT_EQ(fault_of(header + "j1,0,0,0,0,-1,1,0\nj1,0,0,0,0,-1,1,0\n"), ":3:1: error exists \"j1\" stands twice");
  EXPECT_EQ(fault_of(header + "tool,1,0,0,0,0,1,0,0,0,0,2,0.1\n"),
            ":2:1: error range tool is not a rigid transform: its 3x3 part is no rotation");
  EXPECT_EQ(fault_of(header + "j1,0,\x01,0,0,-1,1,0\n"), ":2:6: error syntax control byte 1 in a table");
  EXPECT_EQ(read_dh_chain("/no/such.csv").error().sentence, "/no/such.csv: error io cannot be read");
}

constexpr const char* two_joints = R"(<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="j1" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 1" rpy="0.1 0.2 0.3"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
<joint name="j2" type="fixed"><parent link="b"/><child link="c"/><origin xyz="1 0 0" rpy="0 0 0"/></joint>
<joint name="j3" type="prismatic"><parent link="a"/><child link="d"/><origin xyz="0 1 0" rpy="0 0 0"/><axis xyz="1 0 0"/>
<limit lower="0.5" upper="1" effort="1" velocity="1"/></joint></robot>)";

TEST_F(ChainFile, ReadsUrdfUpAndDownTheTree) {
  const auto down = read_urdf_chain(write(two_joints), "a", "c");
  ASSERT_TRUE(down.ok()) << down.error().sentence;
  ASSERT_EQ(down->size(), 1);
  // roll, pitch, yaw about fixed axes
  const Pose X = Pose{rotation_z(0.3) * rotation_y(0.2) * rotation_x(0.1) * rotation_y(0.7), {0, 0, 1}};
  EXPECT_LT(difference(forward(*down, std::vector<double>{0.7}), X * Pose{Eigen::Matrix3d::Identity(), {1, 0, 0}}),
            1e-15);
  const auto across = read_urdf_chain(file_, "d", "c");
  ASSERT_TRUE(across.ok()) << across.error().sentence;
  ASSERT_EQ(across->size(), 2);
  const Pose a_from_d = inverse(Pose{Eigen::Matrix3d::Identity(), {0.6, 1, 0}});
  EXPECT_LT(difference(forward(*across, std::vector<double>{0.6, 0.7}),
                       a_from_d * X * Pose{Eigen::Matrix3d::Identity(), {1, 0, 0}}),
            2e-15);
}

TEST_F(ChainFile, RefusesBadUrdf) {
  write(two_joints);
  EXPECT_EQ(read_urdf_chain(file_, "a", "x").error().sentence,
            file_ + ": error unknown link \"x\" is not there, expected one of: a b c d");
  EXPECT_EQ(read_urdf_chain(file_, "b", "c").error().sentence,
            file_ + ": error range no joint moves between \"b\" and \"c\"");
  write("<robot");
  EXPECT_EQ(read_urdf_chain(file_, "a", "x").error().sentence, file_ + ": error syntax is not a URDF");
}

TEST(ChainFileData, PandaFlangeIsWhereItsMakerPutsIt) {
  const std::string file = data_folder() + "/arm/panda.urdf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no reference data at " << file;
  const auto panda = read_urdf_chain(file, "panda_link0", "panda_link8");
  ASSERT_TRUE(panda.ok()) << panda.error().sentence;
  ASSERT_EQ(panda->size(), 7);
  // at zero the Panda's flange stands at x = 0.088, z = 0.333 + 0.316 + 0.384 - 0.107, pointing down
  const Pose flange = forward(*panda, std::vector<double>(7, 0.0));
  EXPECT_LT((flange.p - Eigen::Vector3d(0.088, 0, 0.926)).norm(), 1e-14);
  EXPECT_NEAR(flange.R(2, 2), -1, 1e-14);
}

}  // namespace
}  // namespace kinematics
