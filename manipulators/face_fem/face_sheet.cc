#include "manipulators/face_fem/face_sheet.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace face {
namespace {

using Curve = std::vector<ChartPoint>;

/// n + 1 places from 0 to length whose first step is about `first`, growing (or shrinking) by one ratio.
std::vector<double> graded(int n, double length, double first) {
  double low = 0.5, high = 2;
  const auto sum = [&](double q) { return std::abs(q - 1) < 1e-9 ? double(n) : (std::pow(q, n) - 1) / (q - 1); };
  for (int step = 0; step < 60; ++step) {
    const double q = (low + high) / 2;
    (first * sum(q) < length ? low : high) = q;
  }
  const double q = (low + high) / 2, scale = length / sum(q);
  std::vector<double> at(n + 1, 0);
  for (int k = 0; k < n; ++k) at[k + 1] = at[k] + scale * std::pow(q, k);
  at[n] = length;
  return at;
}

/// n + 1 places from 0 to length, fine at both ends.
std::vector<double> graded_both(int n, double length, double first) {
  const int half = n / 2;
  std::vector<double> at(n + 1);
  if (n % 2 == 0) {
    const std::vector<double> part = graded(half, length / 2, first);
    for (int k = 0; k <= half; ++k) at[k] = part[k], at[n - k] = length - part[k];
  } else {
    // the middle step belongs to both halves
    const std::vector<double> part = graded(half + 1, length / 2 * (n + 1.0) / n, first);
    for (int k = 0; k <= half; ++k) at[k] = part[k], at[n - k] = length - part[k];
  }
  return at;
}

/// the curve at an angle, its ends beyond them
ChartPoint along(const Curve& curve, double angle) {
  if (angle <= curve.front().angle) return curve.front();
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const ChartPoint &p = curve[k - 1], &q = curve[k];
    if (angle > q.angle) continue;
    const double s = q.angle > p.angle ? (angle - p.angle) / (q.angle - p.angle) : 0;
    return {angle, p.height + s * (q.height - p.height), p.radius + s * (q.radius - p.radius)};
  }
  return curve.back();
}

/// A curve of the chart through points of space, angles rising, evened out.
Curve curve_of(const FaceChart& chart, const std::vector<Eigen::Vector3d>& points, int passes) {
  Curve curve;
  for (const Eigen::Vector3d& p : points) {
    const ChartPoint c = chart.of(p);
    if (curve.empty() || c.angle > curve.back().angle + 1e-4) curve.push_back(c);
  }
  for (int pass = 0; pass < passes; ++pass) {
    const Curve old = curve;
    for (std::size_t k = 1; k + 1 < curve.size(); ++k) {
      curve[k].height = (old[k - 1].height + 2 * old[k].height + old[k + 1].height) / 4;
      curve[k].radius = (old[k - 1].radius + 2 * old[k].radius + old[k + 1].radius) / 4;
    }
  }
  return curve;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

FaceChart chart_of(const Head& head, const Landmarks& marks) {
  FaceChart chart;
  const double scale = (marks.at("nasion").y() - marks.at("menton").y()) / 0.105;
  chart.x = head.middle();
  chart.z = (marks.at("left_ear").z() + marks.at("right_ear").z()) / 2 + 0.022 * scale;
  // a mask or scan ends before the ears: its axis lies a head's depth behind the nose
  if (!head.closed()) chart.z = marks.at("nose_tip").z() - 0.105 * scale;
  chart.lower = marks.at("labiomental").y();
  chart.upper = (marks.at("left_brow_middle").y() + marks.at("right_brow_middle").y()) / 2;
  chart.side = 1.31;
  chart.bottom = chart.of(marks.at("menton")).height - 0.007 * scale;
  // the hair line stands 55 to 61 mm above the glabella
  chart.top = chart.of(marks.at("glabella")).height + 0.052 * scale;
  return chart;
}

/// Narrows the chart of what is not all of a head until its border rays meet skin.
void fit_to_skin(const Head& head, FaceChart& chart) {
  const auto share_missed = [&](bool sides) {
    int missed = 0, all = 0;
    for (double s = 0; s <= 1; s += 0.05)
      for (int end : {-1, 1}) {
        const double h = sides ? chart.bottom + s * (chart.top - chart.bottom) : end < 0 ? chart.bottom : chart.top;
        const double a = sides ? end * chart.side : (2 * s - 1) * chart.side;
        missed += !head.outermost(chart.origin(h), chart.direction(a, h));
        ++all;
      }
    return double(missed) / all;
  };
  while (share_missed(true) > 0.15 && chart.side > 0.5) chart.side -= 0.02;
  const auto row_missed = [&](double h) {
    int missed = 0;
    for (double s = -1; s <= 1; s += 0.1)
      missed += !head.outermost(chart.origin(h), chart.direction(s * chart.side, h));
    return missed > 3;
  };
  while (row_missed(chart.top) && chart.top > chart.upper) chart.top -= 0.002;
  while (row_missed(chart.bottom) && chart.bottom < chart.lower) chart.bottom += 0.002;
}

/// Even steps, or steps that are finer at both ends: an eye opens most quickly at its corners.
double spread(double t, bool finer) { return finer ? 0.5 * t + 0.25 * (1 - std::cos(M_PI * t)) : t; }

/// The columns of a row: angles of columns + 1 corners. `knots` are (column, angle) of what must be met, from 0 to the
/// middle excluded; mirror images may differ.
std::vector<double> column_angles(int columns, double side, const std::vector<std::pair<int, double>>& left,
                                  const std::vector<std::pair<int, double>>& right, double step) {
  const int half = columns / 2;
  std::vector<double> angle(columns + 1, 0);
  for (int sign : {-1, 1}) {
    const auto& knots = sign > 0 ? left : right;
    int column = 0;
    double at = 0;
    for (const auto& [next, value] : knots) {
      for (int k = column; k <= next; ++k)
        angle[half + sign * k] = sign * (at + (value - at) * spread(double(k - column) / (next - column), column > 0));
      column = next;
      at = value;
    }
    const std::vector<double> rest = graded(half - column, side - at, step);
    for (int k = 0; k <= half - column; ++k) angle[half + sign * (column + k)] = sign * (at + rest[k]);
  }
  return angle;
}

class Layer {
 public:
  Layer(const Head& head, const Landmarks& marks, int columns, int rows) : head_(head), marks_(marks) {
    sheet_.columns = columns;
    sheet_.rows = rows;
  }

  Result<FaceSheet> lay() {
    sheet_.chart = chart_of(head_, marks_);
    fit_to_skin(head_, sheet_.chart);
    place_rows();
    place_corners();
    cut(sheet_.mouth, mouth_, mouth_);
    for (int eye : {0, 1}) cut(sheet_.eyes[eye], upper_[eye], lower_[eye]);
    if (auto status = check_folds(); !status) return status.error();
    if (auto status = scan(); !status) return status.error();
    make_boxes();
    return std::move(sheet_);
  }

 private:
  void place_rows();
  void place_corners();
  void cut(const Cut& cut, const Curve& upper, const Curve& lower);
  Status check_folds() const;
  Status scan();
  void make_boxes();

  const Head& head_;
  const Landmarks& marks_;
  FaceSheet sheet_;
  std::vector<double> height_;  // of the rows
  Curve mouth_;
  std::array<Curve, 2> upper_, lower_;
  double mouth_height_ = 0, eye_height_ = 0;
  std::vector<bool> known_;  // stacks whose radius the cut has set
};

void Layer::place_rows() {
  const FaceChart& chart = sheet_.chart;
  mouth_ = curve_of(chart, marks_.mouth, 4);
  for (int eye : {0, 1}) {
    upper_[eye] = curve_of(chart, marks_.upper_lid[eye], 2);
    lower_[eye] = curve_of(chart, marks_.lower_lid[eye], 2);
    eye_height_ += (upper_[eye].front().height + upper_[eye].back().height) / 4;
  }
  mouth_height_ = (mouth_.front().height + mouth_.back().height) / 2;
  const int rows = sheet_.rows;
  const int to_mouth = int(std::lround(rows * 10 / 32.0)), to_eye = to_mouth + int(std::lround(rows * 13 / 32.0));
  const double fine = 32.0 / rows;
  const std::vector<double> low = graded(to_mouth, mouth_height_ - chart.bottom, 0.0030 * fine);
  const std::vector<double> middle = graded_both(to_eye - to_mouth, eye_height_ - mouth_height_, 0.0030 * fine);
  const std::vector<double> high = graded(rows - to_eye, chart.top - eye_height_, 0.0034 * fine);
  height_.resize(rows + 1);
  for (int j = 0; j <= to_mouth; ++j) height_[to_mouth - j] = mouth_height_ - low[j];
  for (int j = to_mouth; j <= to_eye; ++j) height_[j] = mouth_height_ + middle[j - to_mouth];
  for (int j = to_eye; j <= rows; ++j) height_[j] = eye_height_ + high[j - to_eye];

  const int half = sheet_.columns / 2;
  const int corner = std::max(2, int(std::lround(half * 6 / 16.0)));
  const int inner = std::max(1, int(std::lround(half * 3 / 16.0)));
  const int outer = std::max(inner + 3, int(std::lround(half * 9 / 16.0)));
  sheet_.mouth = {to_mouth, half - corner, half + corner};
  sheet_.eyes[0] = {to_eye, half + inner, half + outer};
  sheet_.eyes[1] = {to_eye, half - outer, half - inner};
}

void Layer::place_corners() {
  const FaceChart& chart = sheet_.chart;
  const int columns = sheet_.columns, half = columns / 2;
  const double step = 0.05 * 32 / columns;
  const int corner = sheet_.mouth.last - half, inner = sheet_.eyes[0].first - half, outer = sheet_.eyes[0].last - half;
  const std::vector<double> at_mouth =
      column_angles(columns, chart.side, {{corner, mouth_.back().angle}}, {{corner, -mouth_.front().angle}}, step);
  const std::vector<double> at_eyes =
      column_angles(columns, chart.side, {{inner, upper_[0].front().angle}, {outer, upper_[0].back().angle}},
                    {{inner, -upper_[1].back().angle}, {outer, -upper_[1].front().angle}}, step);
  for (int j = 0; j <= sheet_.rows; ++j) {
    const double w = smooth_step((height_[j] - mouth_height_) / (eye_height_ - mouth_height_));
    for (int i = 0; i <= columns; ++i) {
      sheet_.above.push_back(int(sheet_.stacks.size()));
      sheet_.stacks.push_back({(1 - w) * at_mouth[i] + w * at_eyes[i], height_[j], 0});
    }
  }
  sheet_.below = sheet_.above;
  known_.assign(sheet_.stacks.size(), false);
}

/// Bends the rows to the two margins of a cut, less with the distance, and doubles the stacks on it.
void Layer::cut(const Cut& cut, const Curve& upper, const Curve& lower) {
  constexpr double reach = 0.030, beside = 0.030;
  const double row_height = height_[cut.row];
  const FaceSheet before = sheet_;
  for (int j = 1; j < sheet_.rows; ++j) {
    const double fade = 1 - smooth_step(std::abs(height_[j] - row_height) / reach);
    if (fade == 0) continue;
    for (int i = 0; i <= sheet_.columns; ++i) {
      const double angle = before.stacks[before.above[before.corner(i, cut.row)]].angle;
      // beyond the corners the row returns to its own height
      const double out = FaceChart::nominal * std::max(upper.front().angle - angle, angle - upper.back().angle);
      const double side = 1 - smooth_step(out / beside);
      if (side == 0) continue;
      const Curve& curve = j > cut.row ? upper : lower;
      const double shift = along(curve, angle).height - row_height;
      if (j != cut.row) {
        sheet_.stacks[sheet_.above[sheet_.corner(i, j)]].height += fade * side * shift;
      } else {
        const int stack = sheet_.above[sheet_.corner(i, j)];
        const ChartPoint low = along(lower, angle), high = along(upper, angle);
        const double own = sheet_.stacks[stack].height;
        sheet_.stacks[stack].height = own + side * (low.height - row_height);
        if (i < cut.first || i > cut.last) continue;
        sheet_.stacks[stack].radius = low.radius;
        known_[stack] = true;
        if (i == cut.first || i == cut.last) continue;
        sheet_.above[sheet_.corner(i, j)] = int(sheet_.stacks.size());
        sheet_.stacks.push_back({angle, own + side * (high.height - row_height), high.radius});
        known_.push_back(true);
      }
    }
  }
}

Status Layer::check_folds() const {
  for (int j = 0; j < sheet_.rows; ++j)
    for (int i = 0; i < sheet_.columns; ++i) {
      const std::array<int, 4> q = sheet_.quad(i, j);
      for (int k = 0; k < 4; ++k) {
        const ChartPoint &p = sheet_.stacks[q[k]], &next = sheet_.stacks[q[(k + 1) % 4]],
                         &last = sheet_.stacks[q[(k + 3) % 4]];
        const double turn =
            (next.angle - p.angle) * (last.height - p.height) - (next.height - p.height) * (last.angle - p.angle);
        if (turn > 0) continue;
        std::ostringstream text;
        text << "the tissue folds at column " << i << ", row " << j << " of the sheet, near height " << p.height
             << " m and angle " << p.angle * 180 / M_PI << " deg: mouth or eyes are opened too wide for this grid";
        return Error{Fault::inverted, text.str()};
      }
    }
  return success();
}

Status Layer::scan() {
  const FaceChart& chart = sheet_.chart;
  std::vector<double> radius(sheet_.stacks.size(), NAN);
  int missed = 0;
  for (std::size_t k = 0; k < sheet_.stacks.size(); ++k) {
    ChartPoint& c = sheet_.stacks[k];
    if (known_[k]) {
      radius[k] = c.radius;
    } else if (const auto r = head_.outermost(chart.origin(c.height), chart.direction(c.angle, c.height))) {
      radius[k] = *r;
    } else {
      ++missed;
    }
  }
  // a few rays slip in beside an open eye; a scan may have gaps at its borders
  const int allowed = int(sheet_.stacks.size()) / (head_.closed() ? 150 : 20);
  if (missed > allowed) {
    std::ostringstream text;
    text << "the skin has holes where the face is: " << missed << " of " << sheet_.stacks.size() << " rays miss it";
    return Error{Fault::mesh, text.str()};
  }
  // a ray that slips through a hole or into a nostril gets what its neighbours have
  std::vector<std::vector<int>> near(sheet_.stacks.size());
  for (int j = 0; j < sheet_.rows; ++j)
    for (int i = 0; i < sheet_.columns; ++i) {
      const std::array<int, 4> q = sheet_.quad(i, j);
      for (int a : q)
        for (int b : q)
          if (a != b) near[a].push_back(b);
    }
  for (int pass = 0; pass < 4; ++pass) {
    const std::vector<double> old = radius;
    for (std::size_t k = 0; k < radius.size(); ++k) {
      std::vector<double> around;
      for (int n : near[k])
        if (std::isfinite(old[n])) around.push_back(old[n]);
      if (known_[k] || around.empty()) continue;
      std::nth_element(around.begin(), around.begin() + around.size() / 2, around.end());
      const double median = around[around.size() / 2];
      if (!(old[k] > median - 0.010)) radius[k] = median;
    }
  }
  for (std::size_t k = 0; k < radius.size(); ++k) {
    sheet_.stacks[k].radius = radius[k];
    if (std::isfinite(radius[k])) continue;
    return Error{Fault::mesh, "the skin has a hole at the border of the face"};
  }
  return success();
}

Eigen::Vector2d flat(const ChartPoint& c) { return {FaceChart::nominal * c.angle, c.height}; }

void Layer::make_boxes() {
  for (int j = 0; j < sheet_.rows; ++j) {
    sheet_.row_box.emplace_back();
    for (int i = 0; i < sheet_.columns; ++i) {
      sheet_.quad_box.emplace_back();
      for (int k : sheet_.quad(i, j)) sheet_.quad_box.back().extend(flat(sheet_.stacks[k]));
      sheet_.row_box.back().extend(sheet_.quad_box.back());
    }
  }
}

/// bilinear coordinates of p in a quadrilateral of the chart, by Newton; clamped, with the distance left
struct Inside {
  double u, v, miss;
};

Inside inside(const std::array<Eigen::Vector2d, 4>& X, const Eigen::Vector2d& p) {
  double u = 0.5, v = 0.5;
  const auto at = [&](double s, double t) {
    return Eigen::Vector2d((1 - s) * (1 - t) * X[0] + s * (1 - t) * X[1] + s * t * X[2] + (1 - s) * t * X[3]);
  };
  for (int step = 0; step < 8; ++step) {
    const Eigen::Vector2d miss = p - at(u, v);
    const Eigen::Vector2d along_u = (1 - v) * (X[1] - X[0]) + v * (X[2] - X[3]);
    const Eigen::Vector2d along_v = (1 - u) * (X[3] - X[0]) + u * (X[2] - X[1]);
    const double uu = along_u.squaredNorm(), vv = along_v.squaredNorm(), uv = along_u.dot(along_v);
    const double det = uu * vv - uv * uv, gu = along_u.dot(miss), gv = along_v.dot(miss);
    if (!(det > 0)) break;
    double nu = std::clamp(u + (vv * gu - uv * gv) / det, 0.0, 1.0);
    double nv = std::clamp(v + (uu * gv - uv * gu) / det, 0.0, 1.0);
    // on an edge the other coordinate is best chosen alone
    if (nu == 0 || nu == 1) nv = std::clamp(v + (gv - uv * (nu - u)) / vv, 0.0, 1.0);
    if (nv == 0 || nv == 1) nu = std::clamp(u + (gu - uv * (nv - v)) / uu, 0.0, 1.0);
    const double moved = std::abs(nu - u) + std::abs(nv - v);
    u = nu;
    v = nv;
    if (moved < 1e-10) break;
  }
  return {u, v, (p - at(u, v)).norm()};
}

}  // namespace

SheetPlace locate(const FaceSheet& sheet, const ChartPoint& point, CutSide side, int row) {
  const Eigen::Vector2d p = flat(point);
  SheetPlace best;
  best.miss = HUGE_VAL;
  const int from = side == CutSide::above ? row : 0, to = side == CutSide::below ? row : sheet.rows;
  const auto box = [&](int i, int j) { return sheet.quad_box[j * sheet.columns + i].squaredExteriorDistance(p); };
  // the nearest box first: what it gives leaves few others to look at
  int first_i = 0, first_j = from;
  double least = HUGE_VAL;
  for (int j = from; j < to; ++j) {
    if (sheet.row_box[j].squaredExteriorDistance(p) >= least) continue;
    for (int i = 0; i < sheet.columns; ++i)
      if (const double here = box(i, j); here < least) {
        least = here;
        first_i = i;
        first_j = j;
      }
  }
  const auto look = [&](int i, int j) {
    const std::array<int, 4> q = sheet.quad(i, j);
    const Inside in = inside(
        {flat(sheet.stacks[q[0]]), flat(sheet.stacks[q[1]]), flat(sheet.stacks[q[2]]), flat(sheet.stacks[q[3]])}, p);
    if (in.miss < best.miss) best = {i, j, in.u, in.v, in.miss};
  };
  look(first_i, first_j);
  for (int j = from; j < to && best.miss > 1e-12; ++j) {
    if (sheet.row_box[j].squaredExteriorDistance(p) >= best.miss * best.miss) continue;
    for (int i = 0; i < sheet.columns && best.miss > 1e-12; ++i)
      if (box(i, j) < best.miss * best.miss) look(i, j);
  }
  return best;
}

Result<FaceSheet> lay_sheet(const Head& head, const Landmarks& marks, int columns, int rows) {
  return Layer(head, marks, columns, rows).lay();
}

}  // namespace face
