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
    if (nodes_ == 8) expand();
    if (options_.quadrature == Quadrature::gauss27) {
      gauss27();
    } else {
      // how far the map is from affine anywhere in the element; a cell of half-size s deviates by s^2 of it
      const Point middle = at(Eigen::Vector3d::Zero());
      bend_ = 0;
      for (int a = 0; a < nodes_; ++a)
        bend_ = std::max(bend_, (X.col(a) - middle.x - middle.J.transpose() * reference_nodes()[a]).norm());
      divide({Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()}, 0);
    }
    if (nodes_ == 8) collect();
  }

  double sum(int a) const { return sums_[a]; }
  int points() const { return points_; }

 private:
  struct Point {
    Eigen::Vector3d xi, x;
    Eigen::Matrix3d J;  // J(i, j) = dx_j / dxi_i
  };
  /// a box of the reference cube: middle and half edges
  struct Cell {
    Eigen::Vector3d middle, half;
    double volume() const { return 8 * half.prod(); }
  };

  /// the trilinear map as a polynomial in 1 x y z xy yz zx xyz, and sums of weights times those eight
  static std::array<double, 8> monomials(const Eigen::Vector3d& p) {
    return {1, p.x(), p.y(), p.z(), p.x() * p.y(), p.y() * p.z(), p.z() * p.x(), p.x() * p.y() * p.z()};
  }
  void expand() {
    term_.setZero();
    for (int a = 0; a < 8; ++a) {
      const auto sign = monomials(reference_nodes()[a]);
      for (int m = 0; m < 8; ++m) term_.col(m) += sign[m] / 8 * X_.col(a);
    }
    moments_.fill(0);
  }
  void collect() {
    for (int a = 0; a < 8; ++a) {
      const auto sign = monomials(reference_nodes()[a]);
      for (int m = 0; m < 8; ++m) sums_[a] += sign[m] / 8 * moments_[m];
    }
  }

  Point at(const Eigen::Vector3d& xi) const {
    Point p;
    p.xi = xi;
    if (nodes_ == 8) {
      const double x = xi.x(), y = xi.y(), z = xi.z();
      const Eigen::Vector3d along_x = term_.col(1) + y * term_.col(4) + z * term_.col(6) + y * z * term_.col(7);
      const Eigen::Vector3d yz = term_.col(5);
      p.J.row(0) = along_x;
      p.J.row(1) = term_.col(2) + x * term_.col(4) + z * yz + x * z * term_.col(7);
      p.J.row(2) = term_.col(3) + y * yz + x * term_.col(6) + x * y * term_.col(7);
      p.x = term_.col(0) + x * along_x + y * term_.col(2) + z * term_.col(3) + y * z * yz;
      return p;
    }
    double N[20], dN[20][3];
    shape(nodes_, xi, N);
    shape_gradient(nodes_, xi, dN);
    p.x.setZero();
    p.J.setZero();
    for (int a = 0; a < nodes_; ++a) {
      const Eigen::Vector3d node = X_.col(a);
      p.x += N[a] * node;
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
    ++points_;
    if (nodes_ == 8) {
      const auto values = monomials(p.xi);
      for (int m = 0; m < 8; ++m) moments_[m] += volume * values[m];
      return;
    }
    double N[20];
    shape(nodes_, p.xi, N);
    for (int a = 0; a < nodes_; ++a) sums_[a] += volume * N[a];
  }

  void gauss27() {
    const Rule& rule = gauss_rule(nodes_, 3);
    for (int q = 0; q < rule.points; ++q) {
      const Point p = at(rule.xi[q]);
      const double distance = (p.x - centre_).norm();
      if (distance <= radius_) add(p, rule.weight[q] * p.J.determinant() * weight_at(distance));
    }
  }

  void divide(const Cell& cell, int depth) {
    const Point p = at(cell.middle);
    const Eigen::Matrix3d edge = cell.half.asDiagonal() * p.J;  // rows: half edges in space
    const Eigen::Vector3d away = p.x - centre_, size = edge.rowwise().norm();
    const double distance = away.norm(), widest = cell.half.maxCoeff(), slack = 3 * bend_ * widest * widest;
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
    const double longest = 2 * size.maxCoeff();
    // a uniform weight needs no small cells inside, a smooth one does
    if (inside && (options_.weight != Weight::smooth || longest * 2 <= radius_)) return take_inside(cell);
    if (longest * options_.fineness <= radius_ || depth == deepest) return take_border(p, cell, edge, away, distance);
    // thin layers are cut along their long axes first
    const std::array<bool, 3> cut = {size[0] * 4 > longest, size[1] * 4 > longest, size[2] * 4 > longest};
    for (int child = 0; child < 8; ++child) {
      Cell part = cell;
      bool twin = false;
      for (int i = 0; i < 3; ++i) {
        const bool upper = child >> i & 1;
        twin = twin || (upper && !cut[i]);
        if (!cut[i]) continue;
        part.half[i] /= 2;
        part.middle[i] += upper ? part.half[i] : -part.half[i];
      }
      if (!twin) divide(part, depth + 1);
    }
  }

  void take_inside(const Cell& cell) {
    // exact for shape function times Jacobian of a trilinear element with 2 points, of a quadratic one with 3
    const Line& line = gauss_line(nodes_ == 20 || options_.weight == Weight::smooth ? 3 : 2);
    for (int k = 0; k < line.count; ++k)
      for (int j = 0; j < line.count; ++j)
        for (int i = 0; i < line.count; ++i) {
          const Eigen::Vector3d offset(line.position[i], line.position[j], line.position[k]);
          const Point p = at(cell.middle + cell.half.cwiseProduct(offset));
          const double weight = line.weight[i] * line.weight[j] * line.weight[k] / 8 * cell.volume();
          add(p, weight * p.J.determinant() * weight_at((p.x - centre_).norm()));
        }
  }

  /// The part of a small cell that lies inside: that of a flat slab across the line to the centre with the cell's
  /// variance along it, moved outward by what the cell's width across the line adds to the mean distance. So the
  /// volume of the ball comes out to fourth order in cell over radius.
  void take_border(const Point& p, const Cell& cell, const Eigen::Matrix3d& edge, const Eigen::Vector3d& away,
                   double distance) {
    const double along = distance > 0 ? (edge * away).squaredNorm() / (distance * distance) : 0;
    const double across = edge.squaredNorm() - along;
    const double middle = distance + across / (6 * std::max(distance, radius_ / 2)), width = std::sqrt(along);
    const double part = width > 0 ? std::clamp(0.5 + (radius_ - middle) / (2 * width), 0.0, 1.0) : 1;
    if (part == 0) return;
    // what is inside sits at the inner end of the slab: each reference axis takes its share of the way there
    const Eigen::Vector3d inward =
        width > 0 ? Eigen::Vector3d((edge * away) * (-(1 - part) / (width * distance))) : Eigen::Vector3d::Zero();
    const Point there = part < 1 ? at(cell.middle + cell.half.cwiseProduct(inward)) : p;
    const double reach = std::min((there.x - centre_).norm(), radius_);
    add(there, part * cell.volume() * p.J.determinant() * weight_at(reach));
  }

  int nodes_;
  Eigen::Vector3d centre_;
  double radius_;
  SpreadOptions options_;
  Corners X_;
  Eigen::Matrix<double, 3, 8> term_;
  std::array<double, 8> moments_{};
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
