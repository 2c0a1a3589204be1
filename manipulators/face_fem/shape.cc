#include "manipulators/face_fem/shape.h"

#include <cassert>
#include <cmath>

namespace face {
namespace {

constexpr int sign_x[20] = {-1, 1, 1, -1, -1, 1, 1, -1, 0, 1, 0, -1, 0, 1, 0, -1, -1, 1, 1, -1};
constexpr int sign_y[20] = {-1, -1, 1, 1, -1, -1, 1, 1, -1, 0, 1, 0, -1, 0, 1, 0, -1, -1, 1, 1};
constexpr int sign_z[20] = {-1, -1, -1, -1, 1, 1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1, 0, 0, 0, 0};

// along one axis: the factor of a node and its derivative; a mid-edge node (sign 0) carries the bubble 1 - x^2
double factor(int sign, double x) { return sign == 0 ? 1 - x * x : 1 + sign * x; }
double factor_slope(int sign, double x) { return sign == 0 ? -2 * x : sign; }

Rule make_rule(int nodes, int per_axis) {
  Rule rule;
  rule.nodes = nodes;
  const Line& line = gauss_line(per_axis);
  for (int k = 0; k < per_axis; ++k)
    for (int j = 0; j < per_axis; ++j)
      for (int i = 0; i < per_axis; ++i) {
        const int q = rule.points++;
        rule.weight[q] = line.weight[i] * line.weight[j] * line.weight[k];
        rule.xi[q] = {line.position[i], line.position[j], line.position[k]};
        shape(nodes, rule.xi[q], rule.N[q].data());
        shape_gradient(nodes, rule.xi[q], rule.dN[q]);
      }
  return rule;
}

}  // namespace

const std::array<Eigen::Vector3d, 20>& reference_nodes() {
  static const std::array<Eigen::Vector3d, 20> nodes = [] {
    std::array<Eigen::Vector3d, 20> made;
    for (int a = 0; a < 20; ++a) made[a] = Eigen::Vector3d(sign_x[a], sign_y[a], sign_z[a]);
    return made;
  }();
  return nodes;
}

void shape(int nodes, const Eigen::Vector3d& xi, double* N) {
  for (int a = 0; a < nodes; ++a) {
    const double product = factor(sign_x[a], xi.x()) * factor(sign_y[a], xi.y()) * factor(sign_z[a], xi.z());
    if (a >= 8)
      N[a] = product / 4;
    else if (nodes == 8)
      N[a] = product / 8;
    else
      N[a] = product / 8 * (sign_x[a] * xi.x() + sign_y[a] * xi.y() + sign_z[a] * xi.z() - 2);
  }
}

void shape_gradient(int nodes, const Eigen::Vector3d& xi, double (*dN)[3]) {
  for (int a = 0; a < nodes; ++a) {
    const int sign[3] = {sign_x[a], sign_y[a], sign_z[a]};
    double value[3], slope[3];
    for (int i = 0; i < 3; ++i) {
      value[i] = factor(sign[i], xi[i]);
      slope[i] = factor_slope(sign[i], xi[i]);
    }
    const double product = value[0] * value[1] * value[2];
    const double gradient[3] = {slope[0] * value[1] * value[2], value[0] * slope[1] * value[2],
                                value[0] * value[1] * slope[2]};
    const double tail = sign[0] * xi[0] + sign[1] * xi[1] + sign[2] * xi[2] - 2;
    for (int i = 0; i < 3; ++i) {
      if (a >= 8)
        dN[a][i] = gradient[i] / 4;
      else if (nodes == 8)
        dN[a][i] = gradient[i] / 8;
      else
        dN[a][i] = (gradient[i] * tail + product * sign[i]) / 8;
    }
  }
}

Eigen::Matrix3d jacobian(const Corners& X, const Eigen::Vector3d& xi) {
  double dN[20][3];
  const int nodes = static_cast<int>(X.cols());
  shape_gradient(nodes, xi, dN);
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
  for (int a = 0; a < nodes; ++a)
    for (int i = 0; i < 3; ++i) J.row(i) += dN[a][i] * X.col(a).transpose();
  return J;
}

const Rule& gauss_rule(int nodes, int per_axis) {
  static const Rule linear2 = make_rule(8, 2), linear3 = make_rule(8, 3), quadratic2 = make_rule(20, 2),
                    quadratic3 = make_rule(20, 3);
  assert((nodes == 8 || nodes == 20) && (per_axis == 2 || per_axis == 3));
  if (nodes == 8) return per_axis == 2 ? linear2 : linear3;
  return per_axis == 2 ? quadratic2 : quadratic3;
}

const Rule& rule_of(Element element) { return gauss_rule(nodes_of(element), element == Element::hex20 ? 3 : 2); }

const Line& gauss_line(int count) {
  static const std::array<Line, 4> lines = [] {
    std::array<Line, 4> made;
    const double third = 1 / std::sqrt(3.0), far3 = std::sqrt(0.6);
    const double near4 = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)),
                 far4 = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
    const double wide = (18 + std::sqrt(30.0)) / 36, narrow = (18 - std::sqrt(30.0)) / 36;
    made[0] = {1, {0}, {2}};
    made[1] = {2, {-third, third}, {1, 1}};
    made[2] = {3, {-far3, 0, far3}, {5.0 / 9, 8.0 / 9, 5.0 / 9}};
    made[3] = {4, {-far4, -near4, near4, far4}, {narrow, wide, wide, narrow}};
    return made;
  }();
  return lines[count - 1];
}

}  // namespace face
