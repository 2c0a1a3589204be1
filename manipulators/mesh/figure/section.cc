#include "manipulators/mesh/figure/section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

namespace figure {
namespace {

using Edge = std::pair<int, int>;

Edge edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// Centroid and area by triangles fanned out from the first point.
void measure(const Eigen::Vector3d& normal, Loop& loop) {
  const Eigen::Vector3d& o = loop.points.front();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    const Eigen::Vector3d& p = loop.points[i];
    const Eigen::Vector3d& q = loop.points[(i + 1) % loop.points.size()];
    const double signed_area = 0.5 * (p - o).cross(q - o).dot(normal);
    area += signed_area;
    moment += signed_area * (o + p + q) / 3;
    loop.perimeter += (q - p).norm();
  }
  loop.centroid = area != 0 ? Eigen::Vector3d(moment / area) : o;
  loop.area = std::abs(area);
}

}  // namespace

std::vector<Loop> section(const mesh::Surface& surface, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  Eigen::VectorXd height = surface.V.cast<double>() * normal;
  height.array() -= point.dot(normal);
  // a vertex in the plane counts as above it, so that every crossed face is entered and left through edges
  const auto above = [&](int v) { return height[v] >= 0; };

  // each crossed face leads from the edge where it enters to the edge where it leaves
  std::map<Edge, Edge> next;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    Edge in{-1, -1};
    Edge out{-1, -1};
    for (int corner = 0; corner < 3; ++corner) {
      const int a = surface.F(f, corner);
      const int b = surface.F(f, (corner + 1) % 3);
      if (above(a) && !above(b)) {
        in = edge(a, b);
      } else if (!above(a) && above(b)) {
        out = edge(a, b);
      }
    }
    if (in.first >= 0) {
      next[in] = out;
    }
  }

  std::vector<Loop> loops;
  while (!next.empty()) {
    const Edge start = next.begin()->first;
    Loop loop;
    Edge at = start;
    for (auto step = next.find(at); step != next.end(); step = next.find(at)) {
      const double t = height[at.first] / (height[at.first] - height[at.second]);
      const Eigen::Vector3d p = surface.V.row(at.first).transpose().cast<double>();
      const Eigen::Vector3d q = surface.V.row(at.second).transpose().cast<double>();
      loop.points.push_back(p + t * (q - p));
      at = step->second;
      next.erase(step);
    }
    if (at == start && loop.points.size() > 2) {
      measure(normal, loop);
      loops.push_back(std::move(loop));
    }
  }
  std::stable_sort(loops.begin(), loops.end(), [](const Loop& a, const Loop& b) { return a.area > b.area; });
  return loops;
}

}  // namespace figure
