#include "manipulators/mesh/topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace mesh {
namespace {

/// One side of a face, as an edge with its lower vertex first; `forward` tells whether the face runs that way.
struct Side {
  int low, high;
  bool forward;
  bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
  bool operator<(const Side& other) const { return std::pair(low, high) < std::pair(other.low, other.high); }
};

std::vector<Side> sorted_sides(const Eigen::MatrixX3i& F) {
  std::vector<Side> sides;
  sides.reserve(3 * F.rows());
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int a = F(f, corner);
      const int b = F(f, (corner + 1) % 3);
      sides.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::stable_sort(sides.begin(), sides.end());
  return sides;
}

/// Disjoint sets of vertices with path halving.
struct Forest {
  std::vector<int> parent;
  explicit Forest(std::size_t size) : parent(size) { std::iota(parent.begin(), parent.end(), 0); }
  int root(int v) {
    while (parent[v] != v) {
      v = parent[v] = parent[parent[v]];
    }
    return v;
  }
  void unite(int a, int b) { parent[root(a)] = root(b); }
};

void count_edges(const Eigen::MatrixX3i& F, Topology& result, int& edges) {
  const std::vector<Side> sides = sorted_sides(F);
  for (std::size_t begin = 0, end; begin < sides.size(); begin = end) {
    for (end = begin + 1; end < sides.size() && sides[end].same_edge(sides[begin]); ++end) {
    }
    ++edges;
    result.boundary_edges += end - begin == 1;
    result.nonmanifold_edges += end - begin > 2;
    result.misoriented_edges += end - begin == 2 && sides[begin].forward == sides[begin + 1].forward;
  }
}

}  // namespace

std::vector<int> components(const Surface& surface) {
  Forest forest(surface.V.rows());
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    forest.unite(surface.F(f, 0), surface.F(f, 1));
    forest.unite(surface.F(f, 1), surface.F(f, 2));
  }
  std::vector<int> number_of_root(surface.V.rows(), -1);
  std::vector<int> component(surface.F.rows());
  int count = 0;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    int& number = number_of_root[forest.root(surface.F(f, 0))];
    if (number < 0) {
      number = count++;
    }
    component[f] = number;
  }
  return component;
}

Topology topology(const Surface& surface) {
  Topology result;
  const std::vector<int> component = components(surface);
  result.components = component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1;

  std::vector<bool> used(surface.V.rows(), false);
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    const Eigen::Vector3d a = surface.V.row(surface.F(f, 0)).transpose().cast<double>();
    const Eigen::Vector3d b = surface.V.row(surface.F(f, 1)).transpose().cast<double>();
    const Eigen::Vector3d c = surface.V.row(surface.F(f, 2)).transpose().cast<double>();
    result.area += 0.5 * (b - a).cross(c - a).norm();
    result.volume += a.dot(b.cross(c)) / 6;
    for (int corner = 0; corner < 3; ++corner) {
      used[surface.F(f, corner)] = true;
    }
  }
  const int used_vertices = static_cast<int>(std::count(used.begin(), used.end(), true));
  result.unused_vertices = static_cast<int>(surface.V.rows()) - used_vertices;

  int edges = 0;
  count_edges(surface.F, result, edges);
  result.euler = used_vertices - edges + static_cast<int>(surface.F.rows());
  return result;
}

std::vector<std::vector<int>> boundary_loops(const Surface& surface) {
  // sides without a partner, by their first vertex in the face's direction
  const std::vector<Side> sides = sorted_sides(surface.F);
  std::unordered_multimap<int, int> next;
  std::vector<int> starts;
  for (std::size_t begin = 0, end; begin < sides.size(); begin = end) {
    for (end = begin + 1; end < sides.size() && sides[end].same_edge(sides[begin]); ++end) {
    }
    if (end - begin == 1) {
      const Side& side = sides[begin];
      next.emplace(side.forward ? side.low : side.high, side.forward ? side.high : side.low);
      starts.push_back(side.forward ? side.low : side.high);
    }
  }

  std::vector<std::vector<int>> loops;
  for (int start : starts) {
    std::vector<int> loop;
    for (auto step = next.find(start); step != next.end(); step = next.find(loop.back())) {
      loop.push_back(step->second);
      next.erase(step);
    }
    if (!loop.empty()) {
      loops.push_back(std::move(loop));
    }
  }
  std::stable_sort(loops.begin(), loops.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return loops;
}

}  // namespace mesh
