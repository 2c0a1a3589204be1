#include "manipulators/mesh/dress.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "manipulators/mesh/normals.h"

namespace mesh {
namespace {

using Eigen::RowVector3f;
using Eigen::Vector3d;
using Edge = std::pair<int, int>;

Edge edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// One vertex and everything it carries.
struct Point {
  RowVector3f p, n;
  std::array<std::pair<int, float>, Skin::influences> pull;  ///< bone and weight, falling
  std::map<int, float> made_of;                              ///< vertices that were bound, and their shares
};

/// The part of `weight` that `bones` hold.
float held(const Point& point, const std::vector<int>& bones) {
  float sum = 0;
  for (const auto& [bone, weight] : point.pull) {
    if (weight > 0 && std::find(bones.begin(), bones.end(), bone) != bones.end()) {
      sum += weight;
    }
  }
  return sum;
}

/// The point at `share` of the way from a to b, weights mixed and cut back to the largest. It lies on the round surface
/// that the normals tell of, not on the flat face (Phong tessellation, Boubekeur and Alexa 2008), or the border of a
/// garment would show in the shading.
Point between(const Point& a, const Point& b, float share) {
  constexpr float roundness = 0.75F;
  Point mixed;
  const RowVector3f flat = a.p + share * (b.p - a.p);
  const RowVector3f on_a = flat - (flat - a.p).dot(a.n) * a.n;
  const RowVector3f on_b = flat - (flat - b.p).dot(b.n) * b.n;
  mixed.p = flat + roundness * (on_a + share * (on_b - on_a) - flat);
  mixed.n = (a.n + share * (b.n - a.n)).normalized();
  for (const auto& [vertex, part] : a.made_of) {
    mixed.made_of[vertex] += (1 - share) * part;
  }
  for (const auto& [vertex, part] : b.made_of) {
    mixed.made_of[vertex] += share * part;
  }
  std::map<int, float> pull;
  for (const auto& [bone, weight] : a.pull) {
    pull[bone] += (1 - share) * weight;
  }
  for (const auto& [bone, weight] : b.pull) {
    pull[bone] += share * weight;
  }
  std::vector<std::pair<int, float>> order(pull.begin(), pull.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& g, const auto& h) { return g.second > h.second; });
  order.resize(Skin::influences, {0, 0.0F});
  float sum = 0;
  for (const auto& [bone, weight] : order) {
    sum += weight;
  }
  for (int i = 0; i < Skin::influences; ++i) {
    mixed.pull[i] = {order[i].second > 0 ? order[i].first : 0, order[i].second / sum};
  }
  return mixed;
}

/// The surface while it is being cut: faces only grow in number, and both halves of a cut face stay where it was.
class Cutter {
 public:
  explicit Cutter(const Skin& skin);

  void cut(const Garment& garment, int part);
  Skin finished(const Skin& skin, const std::vector<Garment>& garments, int first_part) const;

 private:
  using Level = std::vector<double>;  ///< a function of the vertices, inside where >= 0

  template <class Split>
  void split_edges(const std::map<Edge, int>& marked, Split inside);
  void refine(const Garment& garment, std::vector<bool>& candidate);
  void discard(const Level& level, std::vector<bool>& candidate) const;
  void cut_along(const Level& level, std::vector<bool>& candidate);
  template <class Function>
  Level evaluate(Function function) const;

  std::vector<Point> points_;
  std::vector<Eigen::Vector3i> faces_;
  std::vector<int> part_;
};

Cutter::Cutter(const Skin& skin) : part_(skin.surface.part) {
  for (Eigen::Index v = 0; v < skin.surface.V.rows(); ++v) {
    Point point;
    point.p = skin.surface.V.row(v);
    point.n = skin.surface.N.row(v);
    for (int i = 0; i < Skin::influences; ++i) {
      point.pull[i] = {skin.index(v, i), skin.weight(v, i)};
    }
    for (int i = skin.origin.first[v]; i < skin.origin.first[v + 1]; ++i) {
      point.made_of[skin.origin.vertex[i]] += skin.origin.share[i];
    }
    points_.push_back(point);
  }
  for (Eigen::Index f = 0; f < skin.surface.F.rows(); ++f) {
    faces_.push_back(skin.surface.F.row(f).transpose());
  }
}

template <class Function>
Cutter::Level Cutter::evaluate(Function function) const {
  Level level;
  for (const Point& point : points_) {
    level.push_back(function(point));
  }
  return level;
}

/// Divides every face with marked edges (edge -> its new vertex) so that no corner is left hanging on an edge.
/// `inside(face)` is asked of every piece and of every face that stays whole, and told which face it came from.
template <class Split>
void Cutter::split_edges(const std::map<Edge, int>& marked, Split inside) {
  const std::size_t count = faces_.size();
  for (std::size_t f = 0; f < count; ++f) {
    Eigen::Vector3i face = faces_[f];
    std::array<int, 3> middle;
    int splits = 0;
    for (int corner = 0; corner < 3; ++corner) {
      const auto found = marked.find(edge(face[corner], face[(corner + 1) % 3]));
      middle[corner] = found == marked.end() ? -1 : found->second;
      splits += middle[corner] >= 0;
    }
    if (splits == 0) {
      continue;
    }
    // turn the face until the pattern starts at its first corner
    while (!(splits == 3 || (splits == 1 && middle[0] >= 0) || (splits == 2 && middle[1] < 0))) {
      face = {face[1], face[2], face[0]};
      middle = {middle[1], middle[2], middle[0]};
    }
    std::vector<Eigen::Vector3i> pieces;
    if (splits == 1) {
      pieces = {{face[0], middle[0], face[2]}, {middle[0], face[1], face[2]}};
    } else if (splits == 2) {
      pieces = {{face[0], middle[0], middle[2]}, {middle[0], face[1], face[2]}, {middle[0], face[2], middle[2]}};
    } else {
      pieces = {{face[0], middle[0], middle[2]},
                {middle[0], face[1], middle[1]},
                {middle[2], middle[1], face[2]},
                {middle[0], middle[1], middle[2]}};
    }
    faces_[f] = pieces[0];
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      faces_.push_back(pieces[i]);
      part_.push_back(part_[f]);
      inside(f);
    }
  }
}

/// Cuts the candidate faces where `level` is zero; what is outside is no candidate any more.
void Cutter::cut_along(const Level& level_given, std::vector<bool>& candidate) {
  Level level = level_given;
  std::map<Edge, int> marked;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (!candidate[f]) {
      continue;
    }
    for (int corner = 0; corner < 3; ++corner) {
      const auto [a, b] = edge(faces_[f][corner], faces_[f][(corner + 1) % 3]);
      if ((level[a] < 0) == (level[b] < 0) || level[a] == 0 || level[b] == 0 || marked.count({a, b})) {
        continue;
      }
      const double share = level[a] / (level[a] - level[b]);
      // a cut this near to a vertex would leave slivers: it goes through the vertex
      if (share < 0.03 || share > 0.97) {
        level[share < 0.5 ? a : b] = 0;
        continue;
      }
      marked[{a, b}] = static_cast<int>(points_.size());
      points_.push_back(between(points_[a], points_[b], static_cast<float>(share)));
      level.push_back(0);
    }
  }
  split_edges(marked, [&](std::size_t f) { candidate.push_back(candidate[f]); });
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    // after the cut a face lies on one side: its corner farthest from the border tells which
    double farthest = 0;
    for (int corner = 0; corner < 3; ++corner) {
      const double value = level[faces_[f][corner]];
      farthest = std::abs(value) > std::abs(farthest) ? value : farthest;
    }
    candidate[f] = candidate[f] && farthest >= 0;
  }
}

/// How far a point lies inside balls strung along lines (negative outside), and how thick the string is there.
struct Within {
  double depth = -std::numeric_limits<double>::infinity();
  double radius = std::numeric_limits<double>::infinity();
};

Within within_lines(const Eigen::MatrixX4d& lines, const Vector3d& p) {
  Within within;
  const auto take = [&](double radius, double distance) {
    if (radius - distance > within.depth) {
      within = {radius - distance, radius};
    }
  };
  for (Eigen::Index i = 0; i < lines.rows(); ++i) {
    const double r = lines(i, 3);
    if (r <= 0) {
      continue;
    }
    const Vector3d a = lines.row(i).head<3>().transpose();
    take(r, (p - a).norm());
    if (i + 1 < lines.rows() && lines(i + 1, 3) > 0) {
      const Vector3d along = lines.row(i + 1).head<3>().transpose() - a;
      const double share = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
      take(r + share * (lines(i + 1, 3) - r), (p - a - share * along).norm());
    }
  }
  return within;
}

/// Halves long edges near the lines until the surface is fine enough to show them: finer where they are thin.
void Cutter::refine(const Garment& garment, std::vector<bool>& candidate) {
  std::vector<Within> within;
  const auto look = [&] {
    for (std::size_t v = within.size(); v < points_.size(); ++v) {
      within.push_back(within_lines(garment.lines, points_[v].p.transpose().cast<double>()));
    }
  };
  for (int pass = 0; pass < 6; ++pass) {
    look();
    std::map<Edge, int> marked;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (int corner = 0; candidate[f] && corner < 3; ++corner) {
        const auto [a, b] = edge(faces_[f][corner], faces_[f][(corner + 1) % 3]);
        const double length = (points_[a].p - points_[b].p).norm();
        const bool border_may_cross = std::min(std::abs(within[a].depth), std::abs(within[b].depth)) < length;
        const double wanted = std::max(0.7 * std::min(within[a].radius, within[b].radius), 5e-4);
        if (length > wanted && border_may_cross && !marked.count({a, b})) {
          marked[{a, b}] = static_cast<int>(points_.size());
          points_.push_back(between(points_[a], points_[b], 0.5F));
        }
      }
    }
    if (marked.empty()) {
      return;
    }
    split_edges(marked, [&](std::size_t f) { candidate.push_back(candidate[f]); });
  }
}

/// Faces that may lie in the garment in part: none of its borders leaves them out altogether.
void Cutter::discard(const Level& level, std::vector<bool>& candidate) const {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Eigen::Vector3i& face = faces_[f];
    candidate[f] = candidate[f] && std::max({level[face[0]], level[face[1]], level[face[2]]}) >= 0;
  }
}

void Cutter::cut(const Garment& garment, int part) {
  const auto by_bones = [&](const Point& point) { return held(point, garment.bones) - 0.5; };
  const auto by_plane = [&](Eigen::Index i) {
    const Vector3d n = garment.planes.row(i).head<3>().transpose();
    return [n, d = garment.planes(i, 3), length = n.norm()](const Point& point) {
      return (n.dot(point.p.transpose().cast<double>()) + d) / length;
    };
  };
  std::vector<bool> candidate(faces_.size(), true);
  if (!garment.bones.empty()) {
    discard(evaluate(by_bones), candidate);
  }
  for (Eigen::Index i = 0; i < garment.planes.rows(); ++i) {
    discard(evaluate(by_plane(i)), candidate);
  }
  if (!garment.bones.empty()) {
    cut_along(evaluate(by_bones), candidate);
  }
  for (Eigen::Index i = 0; i < garment.planes.rows(); ++i) {
    cut_along(evaluate(by_plane(i)), candidate);
  }
  if (garment.lines.rows() > 0) {
    refine(garment, candidate);
    cut_along(evaluate([&](const Point& point) {
                return within_lines(garment.lines, point.p.transpose().cast<double>()).depth;
              }),
              candidate);
  }
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (candidate[f]) {
      part_[f] = part;
    }
  }
}

/// Lifts each part by its thickness: where parts of different thickness meet, a vertex becomes one per thickness and a
/// rim joins them.
class Lifter {
 public:
  Lifter(const std::vector<Point>& points, const std::vector<Eigen::Vector3i>& faces, const std::vector<int>& part,
         const std::vector<Garment>& garments, int first_part)
      : points_(points), faces_(faces), part_(part), garments_(garments), first_part_(first_part) {}

  Skin lifted(const Skin& skin);

 private:
  double thickness(int part, int v) const;
  double least(int part, double height) const;
  int smoothing(int part) const { return part < first_part_ ? 0 : garments_[part - first_part_].smoothing; }
  int copy(int v, double thickness, bool rim = false);
  void add_face(const Eigen::Vector3i& face, int part);
  void add_rims();
  void find_neighbours();
  void smooth_directions();
  void smooth();

  const std::vector<Point>& points_;
  const std::vector<Eigen::Vector3i>& faces_;
  const std::vector<int>& part_;
  const std::vector<Garment>& garments_;
  int first_part_;

  /// A new vertex: which old one, how high above the skin, and whether it belongs to a rim. Rims have vertices of their
  /// own, so that the edge of a cloth is an edge and does not round the shading of the cloth beside it.
  using Key = std::tuple<int, double, bool>;
  std::map<Key, int> copies_;
  std::vector<Key> keys_;
  std::vector<int> source_;     ///< of each new vertex, the old one
  std::vector<double> height_;  ///< of each new vertex, above the skin
  std::vector<RowVector3f> p_;
  std::vector<RowVector3f> up_;  ///< of each new vertex, the way in which the cloth is lifted
  std::vector<int> passes_;      ///< of smoothing
  std::vector<double> least_;    ///< height that smoothing leaves
  std::vector<std::vector<int>> neighbours_;
  std::vector<Eigen::Vector3i> new_faces_;
  std::vector<int> new_part_;
};

double Lifter::thickness(int part, int v) const {
  if (part < first_part_) {
    return 0;
  }
  const Garment& garment = garments_[part - first_part_];
  const Vector3d p = points_[v].p.transpose().cast<double>();
  return garment.thickness + std::max(0.0, garment.flare.head<3>().dot(p) + garment.flare[3]);
}

/// What cloth hangs wide by is meant; its bare thickness may be used up by bumps under it.
double Lifter::least(int part, double height) const {
  const double bare = part < first_part_ ? 0 : garments_[part - first_part_].thickness;
  return 0.25 * bare + 0.6 * (height - bare);
}

int Lifter::copy(int v, double thickness, bool rim) {
  const auto [found, is_new] = copies_.try_emplace({v, thickness, rim}, static_cast<int>(source_.size()));
  if (is_new) {
    keys_.emplace_back(v, thickness, rim);
    source_.push_back(v);
    height_.push_back(thickness);
    up_.push_back(points_[v].n);
    p_.push_back(points_[v].p);
  }
  return found->second;
}

void Lifter::add_face(const Eigen::Vector3i& face, int part) {
  new_faces_.push_back(face);
  new_part_.push_back(part);
}

void Lifter::add_rims() {
  std::map<Edge, std::size_t> first_side;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int u = faces_[f][corner];
      const int v = faces_[f][(corner + 1) % 3];
      const auto [side, is_first] = first_side.try_emplace(edge(u, v), f);
      if (is_first) {
        continue;
      }
      const int here = part_[f];
      const int there = part_[side->second];
      if (thickness(here, u) == thickness(there, u) && thickness(here, v) == thickness(there, v)) {
        continue;
      }
      const int uh = copy(u, thickness(here, u), true), vh = copy(v, thickness(here, v), true);
      const int ut = copy(u, thickness(there, u), true), vt = copy(v, thickness(there, v), true);
      const int part = thickness(here, u) > thickness(there, u) ? here : there;
      if (uh != ut) {
        add_face({vh, uh, ut}, part);
      }
      if (vh != vt) {
        add_face({vh, ut, vt}, part);
      }
    }
  }
}

/// Neighbours within the cloth and the number of passes of each vertex; rims have none and follow the cloth.
void Lifter::find_neighbours() {
  passes_.assign(source_.size(), std::numeric_limits<int>::max());
  least_.assign(source_.size(), 0);
  neighbours_.assign(source_.size(), {});
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int v = new_faces_[f][corner];
      passes_[v] = std::min(passes_[v], smoothing(new_part_[f]));
      least_[v] = least(new_part_[f], height_[v]);
      neighbours_[v].push_back(new_faces_[f][(corner + 1) % 3]);
      neighbours_[v].push_back(new_faces_[f][(corner + 2) % 3]);
    }
  }
  for (std::size_t v = 0; v < passes_.size(); ++v) {
    passes_[v] = neighbours_[v].empty() ? 0 : passes_[v];
  }
}

/// Cloth is lifted along normals that know nothing of the small bumps under it.
void Lifter::smooth_directions() {
  constexpr int most = 20;
  for (int pass = 0; pass < most; ++pass) {
    std::vector<RowVector3f> next = up_;
    for (std::size_t v = 0; v < up_.size(); ++v) {
      if (passes_[v] > pass) {
        for (int neighbour : neighbours_[v]) {
          next[v] += up_[neighbour];
        }
        next[v].normalize();
      }
    }
    up_.swap(next);
  }
}

/// Raises or lowers the vertices inside a garment to the height of their neighbours, as often as it says, but never
/// below a part of its thickness above the skin. Only along their directions: borders and stripes stay where they were
/// cut.
void Lifter::smooth() {
  for (std::size_t v = 0; v < p_.size(); ++v) {
    p_[v] += static_cast<float>(height_[v]) * up_[v];
  }
  const int most = passes_.empty() ? 0 : *std::max_element(passes_.begin(), passes_.end());
  for (int pass = 0; pass < most; ++pass) {
    std::vector<RowVector3f> next = p_;
    for (std::size_t v = 0; v < p_.size(); ++v) {
      if (passes_[v] <= pass) {
        continue;
      }
      RowVector3f mean = RowVector3f::Zero();
      for (int neighbour : neighbours_[v]) {
        mean += p_[neighbour] / static_cast<float>(neighbours_[v].size());
      }
      const RowVector3f& skin = points_[source_[v]].p;
      const float height = (mean - skin).dot(up_[v]);
      next[v] = skin + std::max(height, static_cast<float>(least_[v])) * up_[v];
    }
    p_.swap(next);
  }
  for (std::size_t v = 0; v < p_.size(); ++v) {
    const auto [source, height, rim] = keys_[v];
    const auto cloth = copies_.find({source, height, false});
    if (rim && cloth != copies_.end()) {
      p_[v] = p_[cloth->second];
    }
  }
}

Skin Lifter::lifted(const Skin& skin) {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    Eigen::Vector3i face;
    for (int corner = 0; corner < 3; ++corner) {
      const int v = faces_[f][corner];
      face[corner] = copy(v, thickness(part_[f], v));
    }
    add_face(face, part_[f]);
  }
  add_rims();
  find_neighbours();
  smooth_directions();
  smooth();

  Skin result;
  result.bones = skin.bones;
  result.surface.part_names = skin.surface.part_names;
  for (const Garment& garment : garments_) {
    result.surface.part_names.push_back(garment.name);
  }
  result.origin.older = skin.origin.older;
  result.surface.part = new_part_;
  result.surface.V.resize(p_.size(), 3);
  result.index.resize(p_.size(), Skin::influences);
  result.weight.resize(p_.size(), Skin::influences);
  for (std::size_t v = 0; v < p_.size(); ++v) {
    result.surface.V.row(v) = p_[v];
    for (int i = 0; i < Skin::influences; ++i) {
      std::tie(result.index(v, i), result.weight(v, i)) = points_[source_[v]].pull[i];
    }
    for (const auto& [vertex, share] : points_[source_[v]].made_of) {
      result.origin.vertex.push_back(vertex);
      result.origin.share.push_back(share);
    }
    result.origin.first.push_back(static_cast<int>(result.origin.vertex.size()));
  }
  result.surface.F.resize(new_faces_.size(), 3);
  for (std::size_t f = 0; f < new_faces_.size(); ++f) {
    result.surface.F.row(f) = new_faces_[f];
  }
  // vertices that shared their normal before still do, at the same height
  std::map<Key, int> first;
  result.weld.resize(p_.size());
  for (std::size_t v = 0; v < p_.size(); ++v) {
    Key key = keys_[v];
    const int source = std::get<0>(key);
    std::get<0>(key) = source < skin.weld.size() ? skin.weld[source] : source;
    result.weld[v] = first.try_emplace(key, static_cast<int>(v)).first->second;
  }
  vertex_normals(result.surface.V, result.surface.F, result.weld, result.surface.N);
  return result;
}

Skin Cutter::finished(const Skin& skin, const std::vector<Garment>& garments, int first_part) const {
  return Lifter(points_, faces_, part_, garments, first_part).lifted(skin);
}

std::string fault(const Skin& skin, const Garment& garment) {
  for (int bone : garment.bones) {
    if (bone < 0 || bone >= static_cast<int>(skin.bones.size())) {
      return "garment " + garment.name + " covers bone " + std::to_string(bone) + "; the skin has bones 0 to " +
             std::to_string(skin.bones.size() - 1);
    }
  }
  if (!garment.planes.allFinite() || !garment.lines.allFinite() || !std::isfinite(garment.thickness)) {
    return "garment " + garment.name + " needs finite planes, lines and thickness";
  }
  for (Eigen::Index i = 0; i < garment.planes.rows(); ++i) {
    if (garment.planes.row(i).head<3>().norm() < 1e-9) {
      return "garment " + garment.name + ": plane " + std::to_string(i + 1) + " has no direction";
    }
  }
  return "";
}

}  // namespace

Result<Skin> dress(const Skin& skin, const std::vector<Garment>& garments) {
  const int first_part = static_cast<int>(skin.surface.part_names.size());
  Cutter cutter(skin);
  for (std::size_t g = 0; g < garments.size(); ++g) {
    if (const std::string sentence = fault(skin, garments[g]); !sentence.empty()) {
      return Error{"range", sentence};
    }
    cutter.cut(garments[g], first_part + static_cast<int>(g));
  }
  return cutter.finished(skin, garments, first_part);
}

}  // namespace mesh
