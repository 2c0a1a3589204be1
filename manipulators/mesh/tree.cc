#include "manipulators/mesh/tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mesh {
namespace {

constexpr int leaf_size = 6;

/// Share of the way from a to b at which the line meets triangle pqr (Moeller and Trumbore 1997); infinity when it
/// does not.
double crossing(const Eigen::Vector3d& a, const Eigen::Vector3d& direction, const Eigen::Vector3d& p,
                const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d e1 = q - p;
  const Eigen::Vector3d e2 = r - p;
  const Eigen::Vector3d h = direction.cross(e2);
  const double determinant = e1.dot(h);
  if (determinant == 0) {
    return none;
  }
  const Eigen::Vector3d s = a - p;
  const double u = s.dot(h) / determinant;
  const Eigen::Vector3d k = s.cross(e1);
  const double v = direction.dot(k) / determinant;
  if (u < 0 || v < 0 || u + v > 1) {
    return none;
  }
  return e2.dot(k) / determinant;
}

/// Whether the line from a to a + reach * direction passes the box (slab test).
bool passes(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& a, const Eigen::Vector3d& direction, double reach) {
  double enter = 0;
  double leave = reach;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (a[axis] < box.min()[axis] || a[axis] > box.max()[axis]) {
        return false;
      }
      continue;
    }
    double near = (box.min()[axis] - a[axis]) / direction[axis];
    double far = (box.max()[axis] - a[axis]) / direction[axis];
    if (near > far) {
      std::swap(near, far);
    }
    enter = std::max(enter, near);
    leave = std::min(leave, far);
  }
  return enter <= leave;
}

}  // namespace

Tree::Tree(const Eigen::MatrixX3f& V, const Eigen::MatrixX3i& F) : V_(V), F_(F), faces_(F.rows()) {
  std::iota(faces_.begin(), faces_.end(), 0);
  if (!faces_.empty()) {
    build(0, static_cast<int>(faces_.size()));
  }
}

int Tree::build(int begin, int end) {
  const int number = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (int i = begin; i < end; ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      box.extend(V_.row(F_(faces_[i], corner)).transpose().cast<double>());
    }
  }
  nodes_[number].box = box;
  nodes_[number].begin = begin;
  nodes_[number].end = end;
  if (end - begin <= leaf_size) {
    return number;
  }
  // halve along the longest side, at the median of the face centres
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto centre = [&](int f) { return V_(F_(f, 0), axis) + V_(F_(f, 1), axis) + V_(F_(f, 2), axis); };
  const int middle = (begin + end) / 2;
  std::nth_element(faces_.begin() + begin, faces_.begin() + middle, faces_.begin() + end,
                   [&](int f, int g) { return std::pair(centre(f), f) < std::pair(centre(g), g); });
  const int left = build(begin, middle);
  const int right = build(middle, end);
  nodes_[number].left = left;
  nodes_[number].right = right;
  return number;
}

template <class Visit>
void Tree::walk(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const double& reach, Visit visit) const {
  const Eigen::Vector3d direction = b - a;
  std::vector<int> open;
  if (!nodes_.empty()) {
    open.push_back(0);
  }
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (!passes(node.box, a, direction, reach)) {
      continue;
    }
    if (node.left >= 0) {
      open.push_back(node.right);
      open.push_back(node.left);
      continue;
    }
    for (int i = node.begin; i < node.end; ++i) {
      const int f = faces_[i];
      const auto corner = [&](int c) -> Eigen::Vector3d { return V_.row(F_(f, c)).transpose().cast<double>(); };
      const double share = crossing(a, direction, corner(0), corner(1), corner(2));
      if (share > 0 && share < reach) {
        visit(Hit{f, share});
      }
    }
  }
}

Tree::Hit Tree::first_hit(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  Hit first;
  walk(a, b, first.share, [&](const Hit& hit) {
    if (hit.share < first.share) {
      first = hit;
    }
  });
  return first;
}

std::vector<Tree::Hit> Tree::hits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  std::vector<Hit> all;
  const double reach = 1;
  walk(a, b, reach, [&](const Hit& hit) { all.push_back(hit); });
  std::sort(all.begin(), all.end(),
            [](const Hit& g, const Hit& h) { return std::pair(g.share, g.face) < std::pair(h.share, h.face); });
  return all;
}

}  // namespace mesh
