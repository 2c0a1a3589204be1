#include "manipulators/face_fem/face_tissue.h"

#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/face_scan.h"

namespace face {
namespace {

using Eigen::Vector3d;

constexpr double skin_thickness = 0.0018;  // metres
constexpr double film_thickness = 0.0010;
constexpr double thinnest = 0.0020, thickest = 0.030;
constexpr double thinnest_lid = 0.0016;

/// distance along a ray at which it leaves a ball, 0 when it misses
double exit_of(const Vector3d& origin, const Vector3d& direction, const Vector3d& centre, double radius) {
  const Vector3d to = centre - origin;
  const double along = to.dot(direction), square = radius * radius - (to.squaredNorm() - along * along);
  return square > 0 ? along + std::sqrt(square) : 0;
}

/// how far a ray passes a point
double passes(const Vector3d& origin, const Vector3d& direction, const Vector3d& point) {
  return (point - origin).cross(direction).norm();
}

class Stacker {
 public:
  Stacker(const Head& head, const Landmarks& marks, const FaceSheet& sheet, const FaceOptions& options)
      : marks_(marks),
        sheet_(sheet),
        options_(options),
        depth_(sheet.chart, marks, options.depth_scale),
        scan_(scan_face(head, sheet.chart, 0.003)),
        scale_((marks.at("nasion").y() - marks.at("menton").y()) / 0.105) {}

  FaceTissue stack() {
    place_beds();
    place_inner();
    make_nodes();
    make_hexahedra();
    return std::move(out_);
  }

 private:
  Bed bed_of(const ChartPoint& c) const;
  int eye_under(const ChartPoint& c) const;
  void place_beds();
  void place_inner();
  void make_nodes();
  void make_hexahedra();
  std::vector<double> levels(double thickness) const;
  bool over_eye(const std::array<int, 4>& quad) const {
    return std::all_of(quad.begin(), quad.end(), [&](int k) { return out_.bed[k] == Bed::eye; });
  }

  const Landmarks& marks_;
  const FaceSheet& sheet_;
  const FaceOptions& options_;
  TissueDepth depth_;
  FaceScan scan_;
  double scale_;
  FaceTissue out_;
  std::vector<bool> has_film_;  // by stack
  std::vector<int> film_;       // inner node of the film of each stack, -1
};

/// the eyeball in front of whose middle part a ray passes, -1
int Stacker::eye_under(const ChartPoint& c) const {
  const Vector3d from = sheet_.chart.origin(c.height), along = sheet_.chart.direction(c.angle, c.height);
  for (int eye : {0, 1})
    if (passes(from, along, marks_.eyes[eye].centre) < 0.85 * marks_.eyes[eye].radius) return eye;
  return -1;
}

/// Borders in millimetres after general anatomy, scaled with the face: the orbit's rim, the vestibule of the mouth as
/// far as the front edge of the masseter, and a band that is free of bone between jaw and skull behind it.
Bed Stacker::bed_of(const ChartPoint& c) const {
  const FaceChart& chart = sheet_.chart;
  if (eye_under(c) >= 0) return Bed::eye;
  const auto flat = [&](const Vector3d& p) {
    const ChartPoint q = chart.of(p);
    return Eigen::Vector2d(FaceChart::nominal * q.angle, q.height);
  };
  const Eigen::Vector2d here(FaceChart::nominal * c.angle, c.height);
  const bool left = c.angle > 0;
  const std::string who = left ? "left_" : "right_";
  for (int eye : {0, 1}) {
    const Eigen::Vector2d out = here - flat(marks_.eyes[eye].centre);
    if (std::hypot(out.x() / 0.021, out.y() / 0.0165) < scale_) return Bed::free;
  }
  const Eigen::Vector2d corner = flat(marks_.at(who + "mouth_corner")), joint = flat(marks_.at(who + "jaw_joint"));
  const Eigen::Vector2d angle = flat(marks_.at(who + "jaw_angle")), menton = flat(marks_.at("menton"));
  const double across = std::abs(here.x()), mouth = flat(marks_.at("stomion")).y();
  // the vestibule: higher in the middle, down to a slit at its end
  const double reach = std::abs(corner.x()) + 0.030 * scale_, rise = (here.y() > mouth ? 0.0125 : 0.0135) * scale_;
  if (std::pow(across / reach, 3) + std::pow(std::abs(here.y() - mouth) / rise, 3) < 1) return Bed::free;
  // below the border of the jaw, which runs from the chin to the angle
  const double share = std::clamp(across / std::abs(angle.x()), 0.0, 1.0);
  const double border = menton.y() + share * share * (angle.y() - menton.y()) - 0.004 * scale_;
  if (here.y() < border) return Bed::free;
  // jaw and skull part at the mouth in front and below the cheekbone's arch behind
  const double ramus = std::clamp(
      (across - std::abs(corner.x()) - 0.020 * scale_) / (std::abs(joint.x()) - std::abs(corner.x()) - 0.030 * scale_),
      0.0, 1.0);
  const double parting = mouth + ramus * ramus * (3 - 2 * ramus) * (joint.y() - 0.006 * scale_ - mouth);
  if (std::abs(here.y() - parting) < 0.006 * scale_ * ramus) return Bed::free;
  return here.y() < parting ? Bed::jaw : Bed::skull;
}

void Stacker::place_beds() {
  for (const ChartPoint& c : sheet_.stacks) out_.bed.push_back(bed_of(c));
  has_film_.assign(sheet_.stacks.size(), false);
  for (int j = 0; j < sheet_.rows; ++j)
    for (int i = 0; i < sheet_.columns; ++i)
      if (over_eye(sheet_.quad(i, j)))
        for (int k : sheet_.quad(i, j)) has_film_[k] = true;
}

void Stacker::place_inner() {
  const FaceChart& chart = sheet_.chart;
  for (std::size_t k = 0; k < sheet_.stacks.size(); ++k) {
    const ChartPoint& c = sheet_.stacks[k];
    double inner = bone_radius(chart, c, depth_.at(c), scan_.near(c, 0.030));
    if (out_.bed[k] == Bed::eye) {
      const Eyeball& eye = marks_.eyes[eye_under(c)];
      inner = std::max(inner, exit_of(chart.origin(c.height), chart.direction(c.angle, c.height), eye.centre,
                                      eye.radius + film_thickness));
    }
    out_.inner.push_back(inner);
  }
  // the bone is smooth: one pass of the mean over the four stacks of each quadrilateral
  std::vector<double> sum(out_.inner.size(), 0), count(out_.inner.size(), 0);
  for (int j = 0; j < sheet_.rows; ++j)
    for (int i = 0; i < sheet_.columns; ++i)
      for (int a : sheet_.quad(i, j))
        for (int b : sheet_.quad(i, j)) sum[a] += out_.inner[b], count[a] += 1;
  for (std::size_t k = 0; k < out_.inner.size(); ++k) {
    double& inner = out_.inner[k];
    const double skin = sheet_.stacks[k].radius;
    if (out_.bed[k] != Bed::eye) inner = std::clamp(sum[k] / count[k], skin - thickest, skin - thinnest);
  }
}

/// shares of the way from bone to skin, layers + 1 of them
std::vector<double> Stacker::levels(double thickness) const {
  const int n = options_.layers, fat = std::max(1, n / 3), skin = std::max(1, n / 4), deep = n - fat - skin;
  const double outer = 1 - std::min(skin_thickness / thickness, 1.0 / 3), middle = 0.55 * outer;
  std::vector<double> at = {0};
  for (int k = 1; k <= deep; ++k) at.push_back(middle * k / deep);
  for (int k = 1; k <= fat; ++k) at.push_back(middle + (outer - middle) * k / fat);
  for (int k = 1; k <= skin; ++k) at.push_back(outer + (1 - outer) * k / skin);
  return at;
}

void Stacker::make_nodes() {
  const FaceChart& chart = sheet_.chart;
  Model& model = out_.model;
  model.bones = {"skull", "jaw", "eye"};
  film_.assign(sheet_.stacks.size(), -1);
  for (std::size_t k = 0; k < sheet_.stacks.size(); ++k) {
    const ChartPoint& c = sheet_.stacks[k];
    const Vector3d from = chart.origin(c.height), along = chart.direction(c.angle, c.height);
    double inner = out_.inner[k], outer = c.radius;
    Support support;
    if (out_.bed[k] == Bed::eye) outer = std::max(outer, inner + thinnest_lid);
    if (has_film_[k]) {
      film_[k] = support.node = int(model.nodes.size());
      support.bone = 2;
      model.nodes.push_back(from + (inner - film_thickness) * along);
      model.supports.push_back(support);
    }
    std::vector<int> stack;
    for (double share : levels(outer - inner)) {
      stack.push_back(int(model.nodes.size()));
      model.nodes.push_back(from + (inner + share * (outer - inner)) * along);
    }
    if (out_.bed[k] == Bed::skull || out_.bed[k] == Bed::jaw) {
      support.node = stack.front();
      support.bone = out_.bed[k] == Bed::jaw ? 1 : 0;
      model.supports.push_back(support);
    }
    out_.node.push_back(stack);
  }
}

void Stacker::make_hexahedra() {
  Model& model = out_.model;
  const double poisson = options_.poisson, density = 1040;
  model.element = options_.element;
  model.materials = {{"deep", 15e3, poisson, density},
                     {"fat", 5e3, poisson, density},
                     {"skin", 60e3, poisson, density},
                     {"film", 300, 0.499, density}};
  model.layers = {"deep", "fat", "skin", "film"};
  const int n = options_.layers, fat = std::max(1, n / 3), skin = std::max(1, n / 4), deep = n - fat - skin;
  for (int j = 0; j < sheet_.rows; ++j)
    for (int i = 0; i < sheet_.columns; ++i) {
      const std::array<int, 4> q = sheet_.quad(i, j);
      const auto brick = [&](const auto& low, const auto& high, int layer) {
        Hexahedron h;
        for (int k = 0; k < 4; ++k) {
          h.node[k] = low(q[k]);
          h.node[4 + k] = high(q[k]);
        }
        h.layer = h.material = layer;
        model.hexahedra.push_back(h);
      };
      if (over_eye(q)) brick([&](int k) { return film_[k]; }, [&](int k) { return out_.node[k].front(); }, 3);
      for (int level = 0; level < n; ++level)
        brick([&](int k) { return out_.node[k][level]; }, [&](int k) { return out_.node[k][level + 1]; },
              level < deep         ? 0
              : level < deep + fat ? 1
                                   : 2);
      model.skin.push_back({int(model.hexahedra.size()) - 1, 1});
    }
}

}  // namespace

double bone_radius(const FaceChart& chart, const ChartPoint& c, double depth, const std::vector<Vector3d>& skin) {
  const Vector3d from = chart.origin(c.height), along = chart.direction(c.angle, c.height);
  double radius = c.radius;
  for (const Vector3d& p : skin) {
    // the ray from inside enters the ball of this skin point here
    const Vector3d to = p - from;
    const double middle = to.dot(along), square = depth * depth - (to.squaredNorm() - middle * middle);
    if (square > 0) radius = std::min(radius, middle - std::sqrt(square));
  }
  return radius;
}

FaceTissue stack_tissue(const Head& head, const Landmarks& marks, const FaceSheet& sheet, const FaceOptions& options) {
  return Stacker(head, marks, sheet, options).stack();
}

}  // namespace face
