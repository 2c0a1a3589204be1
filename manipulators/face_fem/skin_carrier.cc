#include "manipulators/face_fem/skin_carrier.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))

namespace face {
namespace {

typedef float Quad __attribute__((vector_size(16)));

/// reference coordinates of the corners and mid-edges of a side
constexpr int sign_s[8] = {-1, 1, 1, -1, 0, 1, 0, -1};
constexpr int sign_t[8] = {-1, -1, 1, 1, -1, 0, 1, 0};

/// shape functions of a side with 4 or 8 nodes and their gradients
template <class Real>
void side_shape(int corners, Real s, Real t, Real* N, Real (*dN)[2]) {
  for (int a = 0; a < corners; ++a) {
    const Real p = sign_s[a], q = sign_t[a];
    if (a >= 4) {
      // mid-edge nodes carry a bubble along their edge
      const bool along_s = sign_s[a] == 0;
      const Real bubble = along_s ? 1 - s * s : 1 - t * t, lean = along_s ? 1 + q * t : 1 + p * s;
      N[a] = bubble * lean / 2;
      if (dN != nullptr) {
        dN[a][0] = (along_s ? -2 * s * lean : bubble * p) / 2;
        dN[a][1] = (along_s ? bubble * q : -2 * t * lean) / 2;
      }
      continue;
    }
    const Real f = 1 + p * s, g = 1 + q * t, tail = corners == 8 ? p * s + q * t - 1 : 1;
    N[a] = f * g * tail / 4;
    if (dN != nullptr) {
      const Real slope = corners == 8 ? 1 : 0;
      dN[a][0] = (p * g * tail + f * g * p * slope) / 4;
      dN[a][1] = (q * f * tail + f * g * q * slope) / 4;
    }
  }
}

using Patch = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 8>;

struct Foot {
  double s = 0, t = 0, distance = HUGE_VAL;
};

/// nearest point of a side: Gauss-Newton, kept inside the side
Foot foot_on(const Patch& X, const Eigen::Vector3d& p) {
  const int corners = int(X.cols());
  Foot best;
  double s = 0, t = 0;
  for (int step = 0; step < 12; ++step) {
    double N[8], dN[8][2];
    side_shape(corners, s, t, N, dN);
    Eigen::Vector3d x = Eigen::Vector3d::Zero(), along_s = x, along_t = x;
    for (int a = 0; a < corners; ++a) {
      x += N[a] * X.col(a);
      along_s += dN[a][0] * X.col(a);
      along_t += dN[a][1] * X.col(a);
    }
    const Eigen::Vector3d miss = p - x;
    if (miss.norm() < best.distance) best = {s, t, miss.norm()};
    const double ss = along_s.squaredNorm(), tt = along_t.squaredNorm(), st = along_s.dot(along_t);
    const double det = ss * tt - st * st, gs = along_s.dot(miss), gt = along_t.dot(miss);
    if (!(det > 0)) break;
    double next_s = std::clamp(s + (tt * gs - st * gt) / det, -1.0, 1.0);
    double next_t = std::clamp(t + (ss * gt - st * gs) / det, -1.0, 1.0);
    // on an edge the other coordinate is best chosen alone
    if (std::abs(next_s) == 1) next_t = std::clamp(t + (gt - st * (next_s - s)) / tt, -1.0, 1.0);
    if (std::abs(next_t) == 1) next_s = std::clamp(s + (gs - st * (next_t - t)) / ss, -1.0, 1.0);
    if (std::abs(next_s - s) + std::abs(next_t - t) < 1e-12) break;
    s = next_s;
    t = next_t;
  }
  return best;
}

/// balls round the sides, sorted along one axis so that a search looks at neighbours first
struct Balls {
  std::vector<int> order;
  std::vector<double> key;
  std::vector<Eigen::Vector3d> centre;
  std::vector<double> radius;
  double widest = 0;
  int axis = 0;
};

Balls balls_of(const std::vector<Patch>& patches) {
  Balls balls;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(HUGE_VAL), high = -low;
  for (const Patch& X : patches) {
    const Eigen::Vector3d centre = X.rowwise().mean();
    // a quadratic side bulges beyond its nodes by no more than a quarter of its size
    const double radius = (X.colwise() - centre).colwise().norm().maxCoeff() * (X.cols() == 8 ? 1.25 : 1);
    balls.centre.push_back(centre);
    balls.radius.push_back(radius);
    balls.widest = std::max(balls.widest, radius);
    low = low.cwiseMin(centre);
    high = high.cwiseMax(centre);
  }
  (high - low).maxCoeff(&balls.axis);
  balls.order.resize(patches.size());
  std::iota(balls.order.begin(), balls.order.end(), 0);
  std::stable_sort(balls.order.begin(), balls.order.end(),
                   [&](int a, int b) { return balls.centre[a][balls.axis] < balls.centre[b][balls.axis]; });
  for (int side : balls.order) balls.key.push_back(balls.centre[side][balls.axis]);
  return balls;
}

/// the nearest side and the foot on it
std::pair<int, Foot> nearest(const std::vector<Patch>& patches, const Balls& balls, const Eigen::Vector3d& p) {
  std::pair<int, Foot> best{-1, {}};
  const auto look = [&](int side) {
    if ((balls.centre[side] - p).norm() - balls.radius[side] >= best.second.distance) return;
    const Foot foot = foot_on(patches[side], p);
    // equally near sides: the lower number, so that the order of the search does not matter
    if (foot.distance < best.second.distance || (foot.distance == best.second.distance && side < best.first))
      best = {side, foot};
  };
  const int count = int(patches.size()), axis = balls.axis;
  int up = int(std::lower_bound(balls.key.begin(), balls.key.end(), p[axis]) - balls.key.begin()), down = up - 1;
  while (up < count || down >= 0) {
    const double reach = best.second.distance + balls.widest;
    const bool more_up = up < count && balls.key[up] - p[axis] < reach;
    const bool more_down = down >= 0 && p[axis] - balls.key[down] < reach;
    if (!more_up && !more_down) break;
    if (more_up) look(balls.order[up++]);
    if (more_down) look(balls.order[down--]);
  }
  return best;
}

/// bilinear sides: u = c0 + s c1 + t c2 + s t c3, three floats written a vertex
WIDEST void carry_bilinear(const std::array<int, 8>* corner, const int* start, int sides, const float* s,
                           const float* t, const int* vertex, const float* node, float* out) {
  for (int k = 0; k < sides; ++k) {
    Quad u[4];
    for (int a = 0; a < 4; ++a) {
      const float* from = node + 3 * std::size_t(corner[k][a]);
      u[a] = Quad{from[0], from[1], from[2], 0};
    }
    const Quad c0 = 0.25f * ((u[0] + u[1]) + (u[2] + u[3])), c1 = 0.25f * ((u[1] - u[0]) + (u[2] - u[3]));
    const Quad c2 = 0.25f * ((u[3] - u[0]) + (u[2] - u[1])), c3 = 0.25f * ((u[0] - u[1]) + (u[2] - u[3]));
    for (int v = start[k]; v < start[k + 1]; ++v) {
      const Quad moved = (c0 + s[v] * c1) + t[v] * (c2 + s[v] * c3);
      float* to = out + 3 * std::size_t(vertex[v]);
      to[0] = moved[0];
      to[1] = moved[1];
      to[2] = moved[2];
    }
  }
}

}  // namespace

Result<SkinCarrier> SkinCarrier::bind(const Model& model, const Eigen::Matrix3Xd& vertices) {
  if (model.skin.empty()) return Error{Fault::mesh, "the model has no skin to carry vertices"};
  if (!vertices.allFinite()) return Error{Fault::not_finite, "the skin's vertices must be finite"};
  SkinCarrier carrier;
  carrier.corners_ = nodes_of(model.element) == 20 ? 8 : 4;
  const std::vector<int> nodes = skin_nodes(model);
  std::vector<Patch> patches;
  for (const Side& side : model.skin) {
    Patch X(3, carrier.corners_);
    for (int a = 0; a < carrier.corners_; ++a)
      X.col(a) = model.nodes[model.hexahedra[side.hexahedron].node[side_nodes[side.side][a]]];
    patches.push_back(X);
  }
  const Balls balls = balls_of(patches);
  const int count = int(vertices.cols());
  std::vector<std::pair<int, Foot>> feet(count);
  carrier.distance_.resize(count);
  for (int v = 0; v < count; ++v) {
    feet[v] = nearest(patches, balls, vertices.col(v));
    carrier.distance_[v] = float(feet[v].second.distance);
    carrier.farthest_ = std::max(carrier.farthest_, feet[v].second.distance);
  }
  carrier.vertex_.resize(count);
  std::iota(carrier.vertex_.begin(), carrier.vertex_.end(), 0);
  std::stable_sort(carrier.vertex_.begin(), carrier.vertex_.end(),
                   [&](int a, int b) { return feet[a].first < feet[b].first; });
  int last = -1;
  for (int v : carrier.vertex_) {
    if (feet[v].first != last) {
      last = feet[v].first;
      const Side& side = model.skin[last];
      std::array<int, 8> corner{};
      for (int a = 0; a < carrier.corners_; ++a) {
        const int node = model.hexahedra[side.hexahedron].node[side_nodes[side.side][a]];
        corner[a] = int(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
      }
      carrier.corner_.push_back(corner);
      carrier.start_.push_back(int(carrier.s_.size()));
    }
    carrier.s_.push_back(float(feet[v].second.s));
    carrier.t_.push_back(float(feet[v].second.t));
  }
  carrier.start_.push_back(count);
  return carrier;
}

void SkinCarrier::carry(const float* node_displacement, float* vertex_displacement) const {
  const int sides = int(corner_.size());
  if (corners_ == 4)
    return carry_bilinear(corner_.data(), start_.data(), sides, s_.data(), t_.data(), vertex_.data(), node_displacement,
                          vertex_displacement);
  for (int k = 0; k < sides; ++k)
    for (int v = start_[k]; v < start_[k + 1]; ++v) {
      float N[8];
      side_shape<float>(8, s_[v], t_[v], N, nullptr);
      float* to = vertex_displacement + 3 * std::size_t(vertex_[v]);
      for (int i = 0; i < 3; ++i) {
        float sum = 0;
        for (int a = 0; a < 8; ++a) sum += N[a] * node_displacement[3 * std::size_t(corner_[k][a]) + i];
        to[i] = sum;
      }
    }
}

}  // namespace face
