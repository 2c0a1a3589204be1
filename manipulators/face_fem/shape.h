#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/face_fem/element.h"

namespace face {

/// Reference coordinates of the 20 nodes, each in {-1, 0, 1}: the first 8 are the corners.
const std::array<Eigen::Vector3d, 20>& reference_nodes();

/// Shape functions at the reference point xi in [-1, 1]^3: `nodes` (8 trilinear or 20 serendipity) values into N.
/// They sum to one.
void shape(int nodes, const Eigen::Vector3d& xi, double* N);

/// Their gradients with respect to xi: dN[a][i] = dN_a / dxi_i.
void shape_gradient(int nodes, const Eigen::Vector3d& xi, double (*dN)[3]);

/// Derivative of position by reference coordinates, J(i, j) = dx_j / dxi_i; its determinant is the volume ratio.
Eigen::Matrix3d jacobian(const Corners& X, const Eigen::Vector3d& xi);

/// A tensor-product Gauss rule with the shape functions at its points.
struct Rule {
  int nodes = 0;
  int points = 0;
  std::array<double, 27> weight{};             ///< sum 8
  std::array<Eigen::Vector3d, 27> xi;          ///< x fastest
  std::array<std::array<double, 20>, 27> N{};  ///< value of each node's function
  std::array<double[20][3], 27> dN{};          ///< and its reference gradient
};

/// The rule with `per_axis` (2 or 3) points an axis, for 8 or 20 nodes. Made once.
const Rule& gauss_rule(int nodes, int per_axis);

/// The rule that integrates an element's stiffness.
const Rule& rule_of(Element element);

/// Positions (in [-1, 1]) and weights of the 1-D Gauss-Legendre rule, exact to degree 2 count - 1; count 1 to 4.
struct Line {
  int count = 0;
  std::array<double, 4> position{}, weight{};
};
const Line& gauss_line(int count);

}  // namespace face
