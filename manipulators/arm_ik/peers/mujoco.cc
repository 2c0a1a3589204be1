#include <mujoco/mujoco.h>
#include <unistd.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/arm_ik/peers/peers.h"

namespace arm_ik {

namespace {

std::string place(const kinematics::Pose& X) {
  std::ostringstream out;
  out.precision(17);
  const Eigen::Vector4d wxyz = kinematics::quaternion(X.R);
  out << "pos=\"" << X.p.transpose() << "\" quat=\"" << wxyz.transpose() << '"';
  return out.str();
}

// MuJoCo has no position inverse kinematics: the usual damped least squares loop around its kinematics and Jacobian
class Mujoco : public RestartingPeer {
 public:
  explicit Mujoco(const kinematics::Chain& chain) : RestartingPeer(chain) {
    std::ostringstream xml;
    xml << "<mujoco><compiler angle=\"radian\"/><worldbody>";
    kinematics::Pose X = chain.base;
    for (int i = 0; i < chain.size(); ++i) {
      xml << "<body " << place(X)
          << "><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><joint type=\"hinge\" axis=\"0 0 1\"/>";
      X = link(i);
    }
    xml << "<site name=\"tool\" " << place(X * chain.tool) << "/>";
    for (int i = 0; i < chain.size(); ++i) xml << "</body>";
    xml << "</worldbody></mujoco>";
    // the reader of this release takes files only
    const auto file = std::filesystem::temp_directory_path() / ("arm_ik_peer_" + std::to_string(getpid()) + ".xml");
    std::ofstream(file) << xml.str();
    char fault[1000] = "";
    model_ = mj_loadXML(file.c_str(), nullptr, fault, sizeof fault);
    std::filesystem::remove(file);
    if (model_ != nullptr) data_ = mj_makeData(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;
  ~Mujoco() override {
    if (data_ != nullptr) mj_deleteData(data_);
    if (model_ != nullptr) mj_deleteModel(model_);
  }
  std::string name() const override { return "MuJoCo + DLS"; }

 protected:
  void attempt(const kinematics::Pose& target, double position_tolerance, double rotation_tolerance, double end,
               std::span<double> q) override {
    if (data_ == nullptr) return;
    const int n = chain_.size();
    for (int step = 0; step < 100; ++step) {
      std::copy(q.begin(), q.end(), data_->qpos);
      mj_kinematics(model_, data_);
      mj_comPos(model_, data_);
      Eigen::Matrix<double, 6, 1> e;
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data_->site_xmat);
      e.head<3>() = target.p - Eigen::Map<const Eigen::Vector3d>(data_->site_xpos);
      e.tail<3>() = kinematics::rotation_vector(target.R * R.transpose());
      if (e.head<3>().norm() <= position_tolerance && e.tail<3>().norm() <= rotation_tolerance) return;
      if (step % 16 == 15 && cpu_seconds() > end) return;
      Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> J(6, n);
      mj_jacSite(model_, data_, J.data(), J.data() + 3 * n, 0);
      Eigen::Matrix<double, 6, 6> A = J * J.transpose();
      A.diagonal().array() += 1e-4 * std::min(1.0, e.squaredNorm()) + 1e-12;
      const Eigen::VectorXd dq = J.transpose() * A.ldlt().solve(e);
      const double longest = dq.cwiseAbs().maxCoeff(), cut = longest > 0.5 ? 0.5 / longest : 1;
      for (int i = 0; i < n; ++i) q[i] = std::clamp(q[i] + cut * dq[i], chain_.joints[i].lower, chain_.joints[i].upper);
    }
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

}  // namespace

std::unique_ptr<Peer> mujoco_loop(const kinematics::Chain& chain) { return std::make_unique<Mujoco>(chain); }

}  // namespace arm_ik
