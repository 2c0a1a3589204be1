#include "manipulators/face_fem/quadrature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "manipulators/face_fem/shape.h"

namespace face {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int deepest = 24;  // halvings; a cell is then 1e-7 of its element

/// integral of a weight over the whole ball, m3
double whole(Weight weight, double radius) {
  const double cube = 4 * pi * radius * radius * radius;
  return weight == Weight::smooth ? cube * (1.0 / 3 - 2.0 / 5 + 1.0 / 7) : cube / 3;
}

/// sums weight times shape functions over points of one element
class Sphere {
 public:
  Sphere(const Model& model, const Eigen::Vector3d& centre, double radius, const SpreadOptions& options)
      : nodes_(nodes_of(model.element)), centre_(centre), radius_(radius), options_(options) {}

  void integrate(const Corners& X) {
    X_ = X;
    std::fill(sums_.begin(), sums_.end(), 0.0);
    if (options_.quadrature == Quadrature::gauss27) return gauss27();
    // how far the map is from affine anywhere in the element; a cell of half-size s deviates by s^2 of it
    const Point middle = at(Eigen::Vector3d::Zero());
    bend_ = 0;
    for (int a = 0; a < nodes_; ++a)
      bend_ = std::max(bend_, (X.col(a) - middle.x - middle.J.transpose() * reference_nodes()[a]).norm());
    divide(Eigen::Vector3d::Zero(), 1, 0);
  }

  double sum(int a) const { return sums_[a]; }
  int points() const { return points_; }

 private:
  struct Point {
    Eigen::Vector3d x;
    Eigen::Matrix3d J;  // J(i, j) = dx_j / dxi_i
    std::array<double, 20> N;
  };

  Point at(const Eigen::Vector3d& xi) const {
    Point p;
    double dN[20][3];
    shape(nodes_, xi, p.N.data());
    shape_gradient(nodes_, xi, dN);
    p.x.setZero();
    p.J.setZero();
    for (int a = 0; a < nodes_; ++a) {
      const Eigen::Vector3d node = X_.col(a);
      p.x += p.N[a] * node;
      for (int i = 0; i < 3; ++i) p.J.row(i) += dN[a][i] * node.transpose();
    }
    return p;
  }

  double weight_at(double distance) const {
    if (options_.weight != Weight::smooth) return 1;
    const double q = distance / radius_, rest = std::max(0.0, 1 - q * q);
    return rest * rest;
  }

  void add(const Point& p, double volume) {
    for (int a = 0; a < nodes_; ++a) sums_[a] += volume * p.N[a];
    ++points_;
  }

  void gauss27() {
    const Rule& rule = gauss_rule(nodes_, 3);
    for (int q = 0; q < rule.points; ++q) {
      const Point p = at(rule.xi[q]);
      const double distance = (p.x - centre_).norm();
      if (distance <= radius_) add(p, rule.weight[q] * p.J.determinant() * weight_at(distance));
    }
  }

  /// a cell of the reference cube: middle and half edge
  void divide(const Eigen::Vector3d& middle, double half, int depth) {
    const Point p = at(middle);
    const Eigen::Matrix3d edge = half * p.J;  // rows: half edges in space
    const Eigen::Vector3d away = p.x - centre_;
    const double distance = away.norm(), slack = 3 * bend_ * half * half;
    // the cell is apart from the ball when its shadow on the line to the centre is
    const double shadow = distance > 0 ? (edge * away).cwiseAbs().sum() / distance : 0;
    if (distance - shadow - slack >= radius_) return;
    double farthest = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d diagonal =
          edge.row(0) + (corner & 1 ? 1 : -1) * edge.row(1) + (corner & 2 ? 1 : -1) * edge.row(2);
      farthest = std::max(farthest, std::max((away + diagonal).squaredNorm(), (away - diagonal).squaredNorm()));
    }
    const bool inside = std::sqrt(farthest) + slack <= radius_;
    const double longest = 2 * std::sqrt(edge.rowwise().squaredNorm().maxCoeff());
    const bool fine = longest * options_.fineness <= radius_ || depth == deepest;
    // a uniform weight needs no small cells inside, a smooth one does
    if (inside && (options_.weight != Weight::smooth || longest * 2 <= radius_)) return take_inside(middle, half);
    if (fine) return take_border(p, half, away, distance);
    for (int child = 0; child < 8; ++child)
      divide(middle + half / 2 * Eigen::Vector3d(child & 1 ? 1 : -1, child & 2 ? 1 : -1, child & 4 ? 1 : -1), half / 2,
             depth + 1);
  }

  void take_inside(const Eigen::Vector3d& middle, double half) {
    // exact for shape function times Jacobian of a trilinear element with 2 points, of a quadratic one with 3
    const Line& line = gauss_line(nodes_ == 20 || options_.weight == Weight::smooth ? 3 : 2);
    for (int k = 0; k < line.count; ++k)
      for (int j = 0; j < line.count; ++j)
        for (int i = 0; i < line.count; ++i) {
          const Point p = at(middle + half * Eigen::Vector3d(line.position[i], line.position[j], line.position[k]));
          const double weight = line.weight[i] * line.weight[j] * line.weight[k] * half * half * half;
          add(p, weight * p.J.determinant() * weight_at((p.x - centre_).norm()));
        }
  }

  /// The part of a small cell that lies inside: that of a flat slab across the line to the centre with the cell's
  /// variance along it, moved outward by what the cell's width across the line adds to the mean distance. So the
  /// volume of the ball comes out to fourth order in cell over radius.
  void take_border(const Point& p, double half, const Eigen::Vector3d& away, double distance) {
    const Eigen::Matrix3d edge = half * p.J;
    const double along = distance > 0 ? (edge * away).squaredNorm() / (distance * distance) : 0;
    const double across = edge.squaredNorm() - along;
    const double middle = distance + across / (6 * std::max(distance, radius_ / 2)), width = std::sqrt(along);
    const double part = width > 0 ? std::clamp(0.5 + (radius_ - middle) / (2 * width), 0.0, 1.0) : 1;
    if (part > 0) add(p, part * 8 * half * half * half * p.J.determinant() * weight_at(std::min(distance, radius_)));
  }

  int nodes_;
  Eigen::Vector3d centre_;
  double radius_;
  SpreadOptions options_;
  Corners X_;
  double bend_ = 0;
  std::array<double, 20> sums_{};
  int points_ = 0;
};

Error missed(const Eigen::Vector3d& centre, double radius) {
  std::ostringstream text;
  text << "a sphere of radius " << radius << " m at (" << centre.x() << ' ' << centre.y() << ' ' << centre.z()
       << ") holds no tissue";
  return {Fault::missed_sphere, text.str()};
}

}  // namespace

ElementBoxes::ElementBoxes(const Model& model) {
  low_.reserve(model.hexahedra.size());
  high_.reserve(model.hexahedra.size());
  for (int e = 0; e < int(model.hexahedra.size()); ++e) {
    const Corners X = corners_of(model, e);
    Eigen::Vector3d low = X.rowwise().minCoeff(), high = X.rowwise().maxCoeff();
    // a quadratic side bulges beyond its nodes by no more than a quarter
    const Eigen::Vector3d margin = X.cols() == 20 ? Eigen::Vector3d((high - low) / 4) : Eigen::Vector3d::Zero();
    low_.push_back(low - margin);
    high_.push_back(high + margin);
  }
}

std::vector<int> ElementBoxes::near(const Eigen::Vector3d& centre, double radius) const {
  std::vector<int> found;
  for (std::size_t e = 0; e < low_.size(); ++e) {
    const Eigen::Vector3d gap = (low_[e] - centre).cwiseMax(centre - high_[e]).cwiseMax(0.0);
    if (gap.squaredNorm() <= radius * radius) found.push_back(int(e));
  }
  return found;
}

Result<Spread> spread(const Model& model, const ElementBoxes& boxes, const Eigen::Vector3d& centre, double radius,
                      const SpreadOptions& options) {
  if (!centre.allFinite()) return Error{Fault::not_finite, "the centre of a muscle's end must be finite"};
  if (!std::isfinite(radius) || radius <= 0)
    return Error{Fault::muscle, "the radius of a muscle's end must be positive here, is " + std::to_string(radius)};
  Sphere sphere(model, centre, radius, options);
  Spread result;
  const int count = nodes_of(model.element);
  for (int e : boxes.near(centre, radius)) {
    sphere.integrate(corners_of(model, e));
    for (int a = 0; a < count; ++a)
      if (sphere.sum(a) != 0) result.share.emplace_back(model.hexahedra[e].node[a], sphere.sum(a));
  }
  result.points = sphere.points();
  // one entry a node
  std::sort(result.share.begin(), result.share.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < result.share.size(); ++k)
    if (kept > 0 && result.share[kept - 1].first == result.share[k].first)
      result.share[kept - 1].second += result.share[k].second;
    else
      result.share[kept++] = result.share[k];
  result.share.resize(kept);

  double sum = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const auto& [node, share] : result.share) {
    sum += share;
    moment += share * model.nodes[node];
  }
  if (!(sum > 0)) return missed(centre, radius);
  const double ball = whole(options.weight, radius);
  result.centroid = moment / sum;
  result.inside = sum / ball;
  const double divisor = options.weight == Weight::literal ? 1 : options.quadrature == Quadrature::octree ? sum : ball;
  for (auto& entry : result.share) entry.second /= divisor;
  result.total = sum / divisor;
  return result;
}

}  // namespace face
