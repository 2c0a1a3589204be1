#include "manipulators/face_fem/validity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "manipulators/face_fem/shape.h"

namespace face {
namespace {

double degrees(double radians) { return radians * 180 / 3.14159265358979323846; }

/// deformed corner volumes of a brick that may be a wedge
bool corner_inverted(const Corners& X, const Corners& x) {
  static constexpr int edges[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                      {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
  for (int a = 0; a < 8; ++a) {
    const auto triple = [&](const Corners& P) {
      return (P.col(edges[a][0]) - P.col(a)).cross(P.col(edges[a][1]) - P.col(a)).dot(P.col(edges[a][2]) - P.col(a));
    };
    if (triple(X) > 0 && triple(x) <= 0) return true;
  }
  return false;
}

void look_at(const Model& model, int e, const Corners& u, const Rule& rule, Validity& validity, double& rest,
             double& moved) {
  const Corners X = corners_of(model, e), x = X + u;
  bool inverted = corner_inverted(X, x);
  for (int q = 0; q < rule.points; ++q) {
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20> local(3, rule.nodes);
    for (int a = 0; a < rule.nodes; ++a) local.col(a) << rule.dN[q][a][0], rule.dN[q][a][1], rule.dN[q][a][2];
    const Eigen::Matrix3d J = local * X.transpose();
    const Eigen::Matrix3d H = u * (J.inverse() * local).transpose();
    const Eigen::Matrix3d strain = (H + H.transpose()) / 2;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(strain, Eigen::EigenvaluesOnly);
    const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
    if (!(largest <= validity.strain)) {
      validity.strain = largest;
      validity.strained_element = e;
    }
    const Eigen::Vector3d turn(H(2, 1) - H(1, 2), H(0, 2) - H(2, 0), H(1, 0) - H(0, 1));
    validity.turn = std::max(validity.turn, turn.norm() / 2);
    const double det = J.determinant(), ratio = (Eigen::Matrix3d::Identity() + H).determinant();
    rest += rule.weight[q] * det;
    moved += rule.weight[q] * det * ratio;
    inverted = inverted || !(ratio > 0);
  }
  if (!inverted) return;
  if (validity.inverted++ == 0) validity.inverted_element = e;
}

}  // namespace

const char* Validity::word() const {
  if (inverted > 0) return "inverted";
  if (bone_turn > bone_turn_limit) return "bone_turn";
  return strain <= strain_limit ? "ok" : "strain";
}

double bone_turn(const Model& model, const Field& shift, int bone) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  int count = 0;
  for (const Support& s : model.supports)
    if (s.bone == bone) {
      from += model.nodes[s.node];
      to += model.nodes[s.node] + shift.col(s.node);
      ++count;
    }
  if (count < 3) return 0;
  from /= count;
  to /= count;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (const Support& s : model.supports)
    if (s.bone == bone) {
      const Eigen::Vector3d rest = model.nodes[s.node] - from;
      H += (rest + from + shift.col(s.node) - to) * rest.transpose();
    }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const Eigen::Vector3d axis(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(axis.norm(), R.trace() - 1);
}

Validity validity_of(const Model& model, const Field& u) {
  Validity validity;
  const Rule& rule = gauss_rule(nodes_of(model.element), 2);
  double rest = 0, moved = 0;
  Corners mine(3, rule.nodes);
  for (int e = 0; e < int(model.hexahedra.size()); ++e) {
    for (int a = 0; a < rule.nodes; ++a) mine.col(a) = u.col(model.hexahedra[e].node[a]);
    look_at(model, e, mine, rule, validity, rest, moved);
  }
  validity.volume = rest > 0 ? moved / rest - 1 : 0;
  const int bones = std::max<int>(1, int(model.bones.size()));
  for (int bone = 0; bone < bones; ++bone)
    if (const double turn = bone_turn(model, u, bone); turn > validity.bone_turn) {
      validity.bone_turn = turn;
      validity.turned_bone = bone;
    }
  return validity;
}

std::vector<std::string> warnings_of(const Model& model, const Validity& v) {
  std::vector<std::string> warnings;
  const auto warn = [&](auto... words) {
    std::ostringstream text;
    (text << ... << words);
    warnings.push_back(text.str());
  };
  if (v.inverted > 0)
    warn(v.inverted, " elements are turned inside out, the first is ", model.label_of_hexahedron(v.inverted_element),
         "; the load is beyond the linear model");
  if (v.bone_turn > Validity::bone_turn_limit)
    warn("a bone turns by ", degrees(v.bone_turn), " degrees; the linear model holds to 2");
  if (v.strain > Validity::strain_limit)
    warn("strain is ", v.strain, " in element ", model.label_of_hexahedron(v.strained_element),
         "; the linear model holds to ", Validity::strain_limit);
  return warnings;
}

}  // namespace face
