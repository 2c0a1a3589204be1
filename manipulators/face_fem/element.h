#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "manipulators/face_fem/error.h"

namespace face {

/// How an isoparametric hexahedron turns nodal displacements into strain energy. Node order is that of Abaqus and
/// CalculiX: corners 1-4 anticlockwise seen from the top, 5-8 above them, 9-12 on the edges 12 23 34 41, 13-16 on
/// 56 67 78 85, 17-20 on 15 26 37 48.
enum class Element {
  hex8,   ///< 8 nodes, 2x2x2 points; locks in bending and near incompressibility (C3D8)
  bbar,   ///< 8 nodes, the dilatation replaced by its mean over the element (Nagtegaal 1974, Hughes 1980)
  wt,     ///< 8 nodes, three incompatible bubble modes with Taylor's constant Jacobian (Taylor, Beresford, Wilson 1976)
  hex20,  ///< 20 nodes, 3x3x3 points (C3D20)
  hex20r,  ///< 20 nodes, 2x2x2 points; one spare mode an element, harmless in rows at least two wide (C3D20R)
};

constexpr std::array<Element, 5> all_elements = {Element::hex8, Element::bbar, Element::wt, Element::hex20,
                                                 Element::hex20r};

/// The word of an element: "hex8" "bbar" "wt" "hex20" "hex20r".
std::string_view name_of(Element element);
std::optional<Element> element_named(std::string_view name);

/// 8 or 20.
constexpr int nodes_of(Element element) { return element == Element::hex20 || element == Element::hex20r ? 20 : 8; }

/// Lame's constants, pascals.
struct Lame {
  double lambda = 0;
  double mu = 0;
  double bulk() const { return lambda + 2 * mu / 3; }
};

/// Corner positions of up to 20 nodes, 3 by #nodes.
using Corners = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20>;

/// Symmetric element stiffness, 3n by 3n with n = nodes_of(element), N/m; row 3a+i belongs to node a, axis i.
/// `X` is 3 by n. The caller has checked that the Jacobian is positive (check.h).
/// Rigid motions and constant strain are reproduced to rounding by all elements (patch test).
Eigen::MatrixXd stiffness_of(Element element, const Corners& X, Lame lame);

/// Stress at the element's integration points for nodal displacements `u` (3 by n): 6 by #points,
/// rows xx yy zz xy yz zx, pascals.
Eigen::Matrix<double, 6, Eigen::Dynamic> point_stress(Element element, const Corners& X, const Corners& u, Lame lame);

/// The same carried to the nodes, 6 by n: corners by the trilinear (2x2x2) or triquadratic (3x3x3) polynomial through
/// the points, mid-edge nodes as the mean of their two corners.
Eigen::Matrix<double, 6, Eigen::Dynamic> nodal_stress(Element element, const Corners& X, const Corners& u, Lame lame);

}  // namespace face
