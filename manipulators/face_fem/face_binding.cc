#include "manipulators/face_fem/face_binding.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <queue>

namespace face {
namespace {

using Eigen::Vector3d;

/// deeper than this under the sheet a vertex is inside: in the mouth, behind a lid, in a nostril
constexpr double inside_depth = 0.0025;
/// over these depths the motion of lips and lids dies away behind them
constexpr double mouth_fade = 0.012, lid_fade = 0.006;
/// the rim of a lid lies on the ball: below the film, by as much as the ball is out of round
constexpr double lid_rim = 0.0050;

/// 1 at 0, 0 from 1 on, with a slope of zero at both ends
double fade(double t) {
  if (t <= 0) return 1;
  return t >= 1 ? 0 : (1 - t * t) * (1 - t * t);
}

/// Catmull and Rom's cubic: weights of four values in a row for a place u between the middle two.
std::array<double, 4> cubic(double u) {
  return {u * (-0.5 + u * (1 - 0.5 * u)), 1 + u * u * (-2.5 + 1.5 * u), u * (0.5 + u * (2 - 1.5 * u)),
          u * u * (-0.5 + 0.5 * u)};
}

/// A short list of indices with their sums of weights.
class Sums {
 public:
  void add(int index, double weight) {
    for (auto& [i, w] : all_)
      if (i == index) {
        w += weight;
        return;
      }
    all_.push_back({index, weight});
  }
  const std::vector<std::pair<int, double>>& all() const { return all_; }

 private:
  std::vector<std::pair<int, double>> all_;
};

class Binder {
 public:
  Binder(const Head& head, const Landmarks& marks, const FaceSheet& sheet, const FaceTissue& tissue, double reach)
      : head_(head), marks_(marks), sheet_(sheet), tissue_(tissue), reach_(reach) {}

  std::vector<FaceCarrier::Row> bind() {
    measure();
    find_sources();
    choose_jaw_frame();
    std::vector<FaceCarrier::Row> rows;
    for (int v = 0; v < int(vertex_.size()); ++v)
      if (near_[v]) bind_vertex(v, rows);
    return rows;
  }

 private:
  /// what is known of a vertex before its weights
  struct Vertex {
    Vector3d at;
    ChartPoint chart;
    double depth = 0;     // under the sheet's skin, metres
    double distance = 0;  // to it
    int source = -1;      // the nearest outer vertex along the surface
    Cut cut;              // whose neighbourhood it is in
    CutSide side = CutSide::any;
    bool mouth = false, lid = false;
  };

  void measure();
  void find_sources();
  void choose_jaw_frame();
  void take_side(Vertex& v, const Vector3d& normal) const;
  void bind_vertex(int v, std::vector<FaceCarrier::Row>& rows) const;
  double cut_height(const Cut& cut, double angle, bool upper) const;
  Sums stencil(const SheetPlace& at) const;
  std::pair<double, double> radii(const SheetPlace& at) const;

  const Head& head_;
  const Landmarks& marks_;
  const FaceSheet& sheet_;
  const FaceTissue& tissue_;
  double reach_;
  std::vector<Vertex> vertex_;
  std::vector<bool> near_;
  std::array<int, 4> jaw_node_ = {-1, -1, -1, -1};
  Eigen::Matrix4d jaw_frame_;  // barycentric weights of (x, y, z, 1)
};

/// inner and outer radius of the tissue at a place
std::pair<double, double> Binder::radii(const SheetPlace& at) const {
  const std::array<int, 4> q = sheet_.quad(at.i, at.j);
  const double w[4] = {(1 - at.u) * (1 - at.v), at.u * (1 - at.v), at.u * at.v, (1 - at.u) * at.v};
  double inner = 0, skin = 0;
  for (int k = 0; k < 4; ++k) {
    const Vector3d from = sheet_.chart.origin(sheet_.stacks[q[k]].height);
    inner += w[k] * (tissue_.model.nodes[tissue_.node[q[k]].front()] - from).norm();
    skin += w[k] * (tissue_.model.nodes[tissue_.node[q[k]].back()] - from).norm();
  }
  return {inner, skin};
}

void Binder::measure() {
  const Eigen::Index count = head_.skin().V.rows();
  Eigen::AlignedBox2d whole;
  for (const Eigen::AlignedBox2d& row : sheet_.row_box) whole.extend(row);
  vertex_.resize(count);
  near_.assign(count, false);
  for (Eigen::Index v = 0; v < count; ++v) {
    Vertex& vertex = vertex_[v];
    vertex.at = head_.skin().V.row(v).transpose().cast<double>();
    vertex.chart = sheet_.chart.of(vertex.at);
    // on the flat chart distances beside the sheet are at most twice the true ones
    const Eigen::Vector2d flat(FaceChart::nominal * vertex.chart.angle, vertex.chart.height);
    if (whole.exteriorDistance(flat) > 2 * reach_) continue;
    const SheetPlace at = locate(sheet_, vertex.chart);
    const auto [inner, skin] = radii(at);
    ChartPoint foot = vertex.chart;
    if (at.miss > 0) {
      // the nearest point of the border
      const std::array<int, 4> q = sheet_.quad(at.i, at.j);
      const double w[4] = {(1 - at.u) * (1 - at.v), at.u * (1 - at.v), at.u * at.v, (1 - at.u) * at.v};
      foot = {};
      for (int k = 0; k < 4; ++k) {
        foot.angle += w[k] * sheet_.stacks[q[k]].angle;
        foot.height += w[k] * sheet_.stacks[q[k]].height;
      }
    }
    foot.radius = skin;
    vertex.depth = skin - vertex.chart.radius;
    vertex.distance = (vertex.at - sheet_.chart.point(foot)).norm();
    near_[v] = at.miss < 1e-9 || vertex.distance < reach_;
  }
}

/// height of a margin of a cut at an angle; beyond its ends that of the row
double Binder::cut_height(const Cut& cut, double angle, bool upper) const {
  const auto& corner = upper ? sheet_.above : sheet_.below;
  for (int i = 0; i < sheet_.columns; ++i) {
    const ChartPoint &p = sheet_.stacks[corner[sheet_.corner(i, cut.row)]],
                     &q = sheet_.stacks[corner[sheet_.corner(i + 1, cut.row)]];
    if (angle > q.angle && i + 1 < sheet_.columns) continue;
    const double s = std::clamp((angle - p.angle) / (q.angle - p.angle), 0.0, 1.0);
    return p.height + s * (q.height - p.height);
  }
  return 0;
}

/// Near the cleft the lower lip is what faces up; elsewhere, and at the lids, the side of the middle line decides.
void Binder::take_side(Vertex& v, const Vector3d& normal) const {
  const auto within = [&](const Cut& cut, double more) {
    const double first = sheet_.stacks[sheet_.above[sheet_.corner(cut.first, cut.row)]].angle;
    const double last = sheet_.stacks[sheet_.above[sheet_.corner(cut.last, cut.row)]].angle;
    const double beside = more / FaceChart::nominal;
    return v.chart.angle > first - beside && v.chart.angle < last + beside;
  };
  const auto off = [&](const Cut& cut) {
    return v.chart.height - (cut_height(cut, v.chart.angle, true) + cut_height(cut, v.chart.angle, false)) / 2;
  };
  if (within(sheet_.mouth, 0.003)) {
    const double up = off(sheet_.mouth);
    if (std::abs(up) < 0.020) {
      v.mouth = std::abs(up) < 0.011;
      v.cut = sheet_.mouth;
      v.side = (std::abs(up) < 0.003 && std::abs(normal.y()) > 0.3 ? normal.y() < 0 : up > 0) ? CutSide::above
                                                                                              : CutSide::below;
      return;
    }
  }
  for (const Cut& eye : sheet_.eyes) {
    if (!within(eye, 0.002)) continue;
    const double up = off(eye);
    if (std::abs(up) > 0.016) continue;
    v.lid = true;
    v.cut = eye;
    v.side = up > 0 ? CutSide::above : CutSide::below;
    return;
  }
}

/// Outer vertices choose their side themselves; those inside follow the nearest outer one along the surface.
void Binder::find_sources() {
  const mesh::Surface& skin = head_.skin();
  const int count = int(vertex_.size());
  std::vector<std::vector<int>> edges(count);
  std::vector<Vector3d> normal(count, Vector3d::Zero());
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const Eigen::RowVector3i c = skin.F.row(f);
    const Vector3d n = (vertex_[c[1]].at - vertex_[c[0]].at).cross(vertex_[c[2]].at - vertex_[c[0]].at);
    for (int k = 0; k < 3; ++k) {
      normal[c[k]] += n;
      edges[c[k]].push_back(c[(k + 1) % 3]);
      edges[c[k]].push_back(c[(k + 2) % 3]);
    }
  }
  std::vector<double> way(count, HUGE_VAL);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (int v = 0; v < count; ++v) {
    if (!near_[v] || vertex_[v].depth > inside_depth) continue;
    take_side(vertex_[v], normal[v].normalized());
    vertex_[v].source = v;
    way[v] = 0;
    queue.push({0, v});
  }
  while (!queue.empty()) {
    const auto [length, v] = queue.top();
    queue.pop();
    if (length > way[v]) continue;
    for (int next : edges[v]) {
      const double longer = length + (vertex_[next].at - vertex_[v].at).norm();
      if (longer >= way[next]) continue;
      way[next] = longer;
      vertex_[next].source = vertex_[v].source;
      queue.push({longer, next});
    }
  }
  for (Vertex& v : vertex_) {
    if (v.source < 0 || v.depth <= inside_depth) continue;
    const Vertex& source = vertex_[v.source];
    v.cut = source.cut;
    v.side = source.side;
    v.mouth = source.mouth;
    v.lid = source.lid;
  }
}

/// Four nodes of the jaw that span space: the motion of any point that lies on the jaw is their affine sum, exact for
/// turns.
void Binder::choose_jaw_frame() {
  std::vector<int> jaw;
  for (const Support& s : tissue_.model.supports)
    if (s.bone == 1) jaw.push_back(s.node);
  if (jaw.size() < 4) return;
  const auto& X = tissue_.model.nodes;
  const auto best = [&](auto value) {
    return *std::max_element(jaw.begin(), jaw.end(), [&](int a, int b) { return value(a) < value(b); });
  };
  const int left = best([&](int n) { return X[n].x(); }), right = best([&](int n) { return -X[n].x(); });
  const int front = best([&](int n) { return (X[n] - X[left]).cross(X[n] - X[right]).norm(); });
  const Vector3d normal = (X[left] - X[front]).cross(X[right] - X[front]);
  const int off = best([&](int n) { return std::abs(normal.dot(X[n] - X[front])); });
  jaw_node_ = {left, right, front, off};
  Eigen::Matrix4d corners;
  for (int k = 0; k < 4; ++k) corners.col(k) << X[jaw_node_[k]], 1;
  jaw_frame_ = corners.inverse();
}

/// Weights of stacks for a place, smooth over the sheet.
Sums Binder::stencil(const SheetPlace& at) const {
  Sums sum;
  const std::array<double, 4> wu = cubic(at.u), wv = cubic(at.v);
  const auto cut_at = [&](int i, int row) -> const Cut* {
    for (const Cut* cut : {&sheet_.mouth, &sheet_.eyes[0], &sheet_.eyes[1]})
      if (cut->row == row && i > cut->first && i < cut->last) return cut;
    return nullptr;
  };
  // one column: rows from at.j - 1 to at.j + 2, mirrored through the ends of the sheet and the margins of cuts
  const auto add_column = [&](int i, double weight) {
    const auto add = [&](int j, double w) {
      const int corner = sheet_.corner(i, j);
      const int up = sheet_.above[corner], low = sheet_.below[corner];
      if (up == low) {
        sum.add(up, w);
        return;
      }
      // seen from beside the end of a cut both margins count alike
      const Cut* cut = cut_at(i, j);
      const bool beside = cut != nullptr && (at.i >= cut->last || at.i + 1 <= cut->first);
      if (beside) {
        sum.add(up, w / 2);
        sum.add(low, w / 2);
      } else {
        sum.add(at.j >= j ? up : low, w);
      }
    };
    const auto is_end = [&](int j, int toward) {
      if ((j == 0 && toward < 0) || (j == sheet_.rows && toward > 0)) return true;
      const Cut* cut = cut_at(i, j);
      return cut != nullptr && !(at.i >= cut->last || at.i + 1 <= cut->first);
    };
    double inner[2] = {wv[1], wv[2]};
    if (is_end(at.j, -1)) {
      inner[0] += 2 * wv[0];
      inner[1] -= wv[0];
    } else {
      add(at.j - 1, weight * wv[0]);
    }
    if (is_end(at.j + 1, +1)) {
      inner[1] += 2 * wv[3];
      inner[0] -= wv[3];
    } else {
      add(at.j + 2, weight * wv[3]);
    }
    add(at.j, weight * inner[0]);
    add(at.j + 1, weight * inner[1]);
  };
  double inner[2] = {wu[1], wu[2]};
  if (at.i == 0) {
    inner[0] += 2 * wu[0];
    inner[1] -= wu[0];
  } else {
    add_column(at.i - 1, wu[0]);
  }
  if (at.i + 1 == sheet_.columns) {
    inner[1] += 2 * wu[3];
    inner[0] -= wu[3];
  } else {
    add_column(at.i + 2, wu[3]);
  }
  add_column(at.i, inner[0]);
  add_column(at.i + 1, inner[1]);
  return sum;
}

void Binder::bind_vertex(int v, std::vector<FaceCarrier::Row>& rows) const {
  const Vertex& vertex = vertex_[v];
  const SheetPlace at = locate(sheet_, vertex.chart, vertex.side, vertex.cut.row);
  const bool border = (at.i == 0 && at.u == 0) || (at.i + 1 == sheet_.columns && at.u == 1) ||
                      (at.j == 0 && at.v == 0) || (at.j + 1 == sheet_.rows && at.v == 1);
  double amount = border ? fade(vertex.distance / reach_) : 1;
  double skin_share = 1, jaw = 0;
  if (vertex.mouth || vertex.lid) {
    const auto [inner, skin] = radii(at);
    // lips follow their tissue at the depth where they lie; lids are thin: rim and skin move as one, and what is behind
    // the front of the eyeball comes to rest
    double behind = (inner - vertex.chart.radius) / mouth_fade;
    if (vertex.mouth)
      skin_share = std::clamp((vertex.chart.radius - inner) / (skin - inner), 0.0, 1.0);
    else
      behind = (inner - lid_rim - vertex.chart.radius) / lid_fade;
    const double hold = fade(behind);
    if (vertex.mouth && vertex.side == CutSide::below) jaw = (1 - hold) * amount;
    amount *= hold;
  }
  Sums weights;
  const Sums across = stencil(at);
  if (amount > 0)
    for (const auto& [stack, w] : across.all()) {
      weights.add(tissue_.node[stack].back(), amount * skin_share * w);
      if (skin_share < 1) weights.add(tissue_.node[stack].front(), amount * (1 - skin_share) * w);
    }
  if (jaw > 0 && jaw_node_[0] >= 0) {
    Eigen::Vector4d place;
    place << vertex.at, 1;
    const Eigen::Vector4d share = jaw_frame_ * place;
    for (int k = 0; k < 4; ++k) weights.add(jaw_node_[k], jaw * share[k]);
  }
  FaceCarrier::Row row;
  row.vertex = head_.vertex()[v];
  for (const auto& [node, w] : weights.all())
    if (std::abs(w) > 1e-6) {
      row.node.push_back(node);
      row.weight.push_back(float(w));
    }
  if (!row.node.empty()) rows.push_back(row);
}

}  // namespace

std::vector<FaceCarrier::Row> bind_vertices(const Head& head, const Landmarks& marks, const FaceSheet& sheet,
                                            const FaceTissue& tissue, double reach) {
  return Binder(head, marks, sheet, tissue, reach).bind();
}

}  // namespace face
