#include "manipulators/face_fem/check.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "manipulators/face_fem/shape.h"

namespace face {
namespace {

template <class... Words>
Error refuse(Fault fault, const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return {fault, text.str()};
}

std::string place(const Eigen::Vector3d& p) {
  std::ostringstream text;
  text << '(' << p.x() << ' ' << p.y() << ' ' << p.z() << ')';
  return text.str();
}

Status check_numbers(const Model& model) {
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (!model.nodes[n].allFinite())
      return refuse(Fault::not_finite, "node ", model.label_of_node(int(n)), ": a coordinate must be finite, is ",
                    place(model.nodes[n]));
  for (const Material& m : model.materials) {
    if (!std::isfinite(m.young) || !std::isfinite(m.poisson) || !std::isfinite(m.density))
      return refuse(Fault::not_finite, "material ", m.name, ": its constants must be finite");
    if (m.young <= 0) return refuse(Fault::material, "material ", m.name, ": E must be positive, is ", m.young, " Pa");
    if (m.poisson <= -1 || m.poisson >= 0.5)
      return refuse(Fault::material, "material ", m.name, ": nu must lie in (-1, 0.5), is ", m.poisson);
    if (m.density < 0)
      return refuse(Fault::material, "material ", m.name, ": density must not be negative, is ", m.density, " kg/m3");
  }
  return success();
}

Status check_indices(const Model& model) {
  const int nodes = int(model.nodes.size()), used = nodes_of(model.element);
  if (model.hexahedra.empty()) return refuse(Fault::element, "a model needs at least one element, has none");
  std::vector<bool> supported(model.nodes.size(), false);
  for (std::size_t e = 0; e < model.hexahedra.size(); ++e) {
    const Hexahedron& h = model.hexahedra[e];
    const int label = model.label_of_hexahedron(int(e));
    if (h.material < 0 || h.material >= int(model.materials.size()))
      return refuse(Fault::unknown, "element ", label, ": has no material");
    for (int a = 0; a < used; ++a)
      if (h.node[a] < 0 || h.node[a] >= nodes)
        return refuse(Fault::unknown, "element ", label, ": place ", a + 1, " of its nodes names no node");
  }
  for (const Support& s : model.supports) {
    if (s.node < 0 || s.node >= nodes) return refuse(Fault::unknown, "a support names no node: index ", s.node);
    if (supported[s.node]) return refuse(Fault::unknown, "node ", model.label_of_node(s.node), ": is supported twice");
    supported[s.node] = true;
    if (!s.shift.allFinite())
      return refuse(Fault::not_finite, "node ", model.label_of_node(s.node), ": its given displacement must be finite");
  }
  for (const Side& side : model.skin)
    if (side.hexahedron < 0 || side.hexahedron >= int(model.hexahedra.size()) || side.side < 0 || side.side > 5)
      return refuse(Fault::unknown, "the skin names no side: element index ", side.hexahedron, " side ", side.side + 1);
  return success();
}

/// nodes along the three edges that leave each corner, in right-handed order
constexpr int corner_edges[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                    {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

bool repeats_a_node(const Hexahedron& h, int used) {
  for (int a = 0; a < used; ++a)
    for (int b = 0; b < a; ++b)
      if (h.node[a] == h.node[b]) return true;
  return false;
}

/// nodes that are equal must be neighbours along an edge
bool is_wedge(const Hexahedron& h) {
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < a; ++b) {
      if (h.node[a] != h.node[b]) continue;
      const auto& near = corner_edges[a];
      if (near[0] != b && near[1] != b && near[2] != b) return false;
    }
  return true;
}

/// Jacobians where those of fair integration points can still turn over: at the corners, and at the mid-edge nodes of
/// 20-node elements; HUGE_VAL at the collapsed corners of a wedge
std::vector<double> corner_jacobians(const Model& model, int e) {
  const int used = nodes_of(model.element);
  const Hexahedron& h = model.hexahedra[e];
  const Corners X = corners_of(model, e);
  std::vector<double> det(used);
  for (int a = 0; a < used; ++a) {
    if (used == 20) {
      det[a] = jacobian(X, reference_nodes()[a]).determinant();
      continue;
    }
    const auto& to = corner_edges[a];
    if (h.node[to[0]] == h.node[a] || h.node[to[1]] == h.node[a] || h.node[to[2]] == h.node[a]) {
      det[a] = HUGE_VAL;
      continue;
    }
    const Eigen::Vector3d x = X.col(a);
    det[a] = (X.col(to[0]) - x).cross(X.col(to[1]) - x).dot(X.col(to[2]) - x) / 8;
  }
  return det;
}

Status check_shape(const Model& model, int e) {
  const int used = nodes_of(model.element);
  const Hexahedron& h = model.hexahedra[e];
  if (repeats_a_node(h, used) && (used == 20 || !is_wedge(h)))
    return refuse(Fault::element, "element ", model.label_of_hexahedron(e),
                  ": names a node twice that is not the end of a collapsed edge of an 8-node brick");
  if (const std::vector<double> det = corner_jacobians(model, e);
      std::all_of(det.begin(), det.end(), [](double d) { return d <= 0; }))
    return refuse(Fault::numbering, "element ", model.label_of_hexahedron(e),
                  ": its nodes are listed inside out (every corner has a negative Jacobian); list the other ",
                  used == 8 ? "four" : "side", " first");
  return success();
}

/// the sides of all elements, by their sorted corner nodes
struct SideKey {
  std::array<int, 4> corner;
  Side side;
  bool operator<(const SideKey& other) const { return corner < other.corner; }
};

std::vector<SideKey> sorted_sides(const Model& model) {
  std::vector<SideKey> keys;
  keys.reserve(6 * model.hexahedra.size());
  for (int e = 0; e < int(model.hexahedra.size()); ++e)
    for (int s = 0; s < 6; ++s) {
      SideKey key{{}, {e, s}};
      for (int k = 0; k < 4; ++k) key.corner[k] = model.hexahedra[e].node[side_nodes[s][k]];
      std::sort(key.corner.begin(), key.corner.end());
      keys.push_back(key);
    }
  std::sort(keys.begin(), keys.end());
  return keys;
}

Status check_mesh(const Model& model) {
  const std::vector<SideKey> keys = sorted_sides(model);
  for (std::size_t i = 0; i + 2 < keys.size(); ++i)
    if (keys[i].corner == keys[i + 1].corner && keys[i].corner == keys[i + 2].corner &&
        std::adjacent_find(keys[i].corner.begin(), keys[i].corner.end()) == keys[i].corner.end())
      return refuse(Fault::mesh, "elements ", model.label_of_hexahedron(keys[i].side.hexahedron), ", ",
                    model.label_of_hexahedron(keys[i + 1].side.hexahedron), " and ",
                    model.label_of_hexahedron(keys[i + 2].side.hexahedron),
                    " share one side; a side has at most two elements");
  return success();
}

std::string motion_left(const Eigen::Matrix<double, 6, 1>& motion) {
  // a motion is a translation and a rotation about the centre; the larger one names it
  std::ostringstream text;
  const Eigen::Vector3d shift = motion.head<3>(), turn = motion.tail<3>();
  if (shift.norm() >= turn.norm())
    text << "it can still move along " << place(shift.normalized());
  else
    text << "it can still turn about " << place(turn.normalized());
  return text.str();
}

Status check_supports(const Model& model) {
  const std::vector<int> part = parts_of(model);
  const int parts = part.empty() ? 0 : 1 + *std::max_element(part.begin(), part.end());
  struct Part {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(HUGE_VAL), high = -low;
    Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
    int held = 0, example = -1;
  };
  std::vector<Part> all(parts);
  for (std::size_t n = 0; n < part.size(); ++n) {
    if (part[n] < 0) continue;
    Part& p = all[part[n]];
    p.low = p.low.cwiseMin(model.nodes[n]);
    p.high = p.high.cwiseMax(model.nodes[n]);
    if (p.example < 0) p.example = int(n);
  }
  // each held axis is one equation for the six rigid motions, lengths measured in sizes of the part
  for (const Support& s : model.supports) {
    if (part[s.node] < 0) continue;
    Part& p = all[part[s.node]];
    const Eigen::Vector3d arm = (model.nodes[s.node] - (p.low + p.high) / 2) / (p.high - p.low).norm();
    for (int i = 0; i < 3; ++i) {
      if (!s.held[i]) continue;
      ++p.held;
      Eigen::Matrix<double, 6, 1> row;
      row.head<3>() = Eigen::Vector3d::Unit(i);
      row.tail<3>() = arm.cross(Eigen::Vector3d::Unit(i));
      p.gram += row * row.transpose();
    }
  }
  for (const Part& p : all) {
    if (p.held == 0)
      return refuse(Fault::unsupported, "the part with node ", model.label_of_node(p.example),
                    " floats: none of its nodes is held");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(p.gram);
    if (eigen.eigenvalues()[0] < 1e-9 * eigen.eigenvalues()[5])
      return refuse(Fault::unsupported, "the part with node ", model.label_of_node(p.example),
                    " needs at least three held nodes that are not in line; ", p.held, " axes are held and ",
                    motion_left(eigen.eigenvectors().col(0)));
  }
  return success();
}

}  // namespace

std::vector<int> parts_of(const Model& model) {
  std::vector<int> parent(model.nodes.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
  };
  std::vector<bool> used(model.nodes.size(), false);
  for (const Hexahedron& h : model.hexahedra)
    for (int a = 0; a < nodes_of(model.element); ++a) {
      used[h.node[a]] = true;
      parent[root(h.node[a])] = root(h.node[0]);
    }
  std::vector<int> number(model.nodes.size(), -1), part(model.nodes.size(), -1);
  int count = 0;
  for (int n = 0; n < int(model.nodes.size()); ++n) {
    if (!used[n]) continue;
    int& of_root = number[root(n)];
    if (of_root < 0) of_root = count++;
    part[n] = of_root;
  }
  return part;
}

std::vector<int> unused_nodes(const Model& model) {
  const std::vector<int> part = parts_of(model);
  std::vector<int> unused;
  for (std::size_t n = 0; n < part.size(); ++n)
    if (part[n] < 0) unused.push_back(int(n));
  return unused;
}

std::vector<TurnedCorner> turned_corners(const Model& model) {
  std::vector<TurnedCorner> turned;
  for (int e = 0; e < int(model.hexahedra.size()); ++e) {
    const std::vector<double> det = corner_jacobians(model, e);
    const auto worst = std::min_element(det.begin(), det.end());
    if (!(*worst > 0)) turned.push_back({e, model.hexahedra[e].node[worst - det.begin()], *worst});
  }
  return turned;
}

Status check(const Model& model) {
  if (auto status = check_numbers(model); !status) return status;
  if (auto status = check_indices(model); !status) return status;
  for (int e = 0; e < int(model.hexahedra.size()); ++e)
    if (auto status = check_shape(model, e); !status) return status;
  if (auto status = check_mesh(model); !status) return status;
  return check_supports(model);
}

}  // namespace face
