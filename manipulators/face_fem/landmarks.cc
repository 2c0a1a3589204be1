#include "manipulators/face_fem/landmarks.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace face {
namespace {

using Eigen::Vector3d;

template <class... Words>
Error missing(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return {Fault::landmark, text.str()};
}

/// A line of the surface seen from the front, z over some coordinate; z is NaN where no skin is met.
struct Relief {
  std::vector<double> at, z;

  int size() const { return int(at.size()); }
  /// index nearest to a coordinate
  int index(double coordinate) const {
    int best = 0;
    for (int i = 0; i < size(); ++i)
      if (std::abs(at[i] - coordinate) < std::abs(at[best] - coordinate)) best = i;
    return best;
  }
};

/// z along a vertical line, from `high` down to `low`
Relief vertical(const Head& head, double x, double high, double low, double step) {
  Relief relief;
  for (double y = high; y > low; y -= step)
    if (const auto z = head.front(x, y)) {
      relief.at.push_back(y);
      relief.z.push_back(*z);
    }
  return relief;
}

/// Index of the foremost point with low <= coordinate <= high, -1 when there is none.
int foremost(const Relief& relief, double low, double high) {
  int best = -1;
  for (int i = 0; i < relief.size(); ++i)
    if (relief.at[i] >= low && relief.at[i] <= high && (best < 0 || relief.z[i] > relief.z[best])) best = i;
  return best;
}

/// The point between two indices that lies farthest from their chord: behind it for sign -1, before it for +1.
struct Bulge {
  int index = -1;
  double height = 0;  ///< metres, square to the chord
};

Bulge bulge(const Relief& relief, int from, int to, int sign) {
  Bulge best;
  if (from > to) std::swap(from, to);
  if (from < 0 || to - from < 2) return best;
  const double run = relief.at[to] - relief.at[from], rise = relief.z[to] - relief.z[from];
  const double length = std::hypot(run, rise);
  for (int i = from + 1; i < to; ++i) {
    const double above = relief.z[i] - relief.z[from] - rise * (relief.at[i] - relief.at[from]) / run;
    const double height = sign * above * std::abs(run) / length;
    if (height > best.height) best = {i, height};
  }
  return best;
}

/// A dip between two rises close by: how deep the cleft between the lips is at index i.
double notch(const Relief& relief, int i, double reach) {
  double above = -HUGE_VAL, below = -HUGE_VAL;
  for (int k = 0; k < relief.size(); ++k) {
    const double d = relief.at[k] - relief.at[i];
    if (d > 0 && d < reach) above = std::max(above, relief.z[k]);
    if (d < 0 && d > -reach) below = std::max(below, relief.z[k]);
  }
  return std::min(above, below) - relief.z[i];
}

double confidence_of(double height, double clear) { return std::clamp(0.5 + 0.5 * height / clear, 0.5, 1.0); }

/// Gathers what is found; given points win.
class Finder {
 public:
  Finder(const Head& head, const std::map<std::string, Vector3d>& given) : head_(head), given_(given) {}

  Result<Landmarks> find() {
    for (const auto& [name, place] : given_) {
      if (std::find(landmark_names.begin(), landmark_names.end(), name) == landmark_names.end())
        return Error{Fault::unknown, "no landmark is called '" + name + "'"};
      if (!place.allFinite()) return Error{Fault::not_finite, "landmark " + name + " must be finite"};
    }
    for (const std::string& name : landmark_names) {
      Landmark point;
      point.name = name;
      out_.points.push_back(point);
    }
    if (auto status = find_profile(); !status) return status.error();
    if (auto status = find_eyes(); !status) return status.error();
    if (auto status = find_mouth(); !status) return status.error();
    find_sides();
    return std::move(out_);
  }

 private:
  void put(const std::string& name, const Vector3d& place, double confidence, const char* source) {
    const auto i = std::find(landmark_names.begin(), landmark_names.end(), name) - landmark_names.begin();
    const auto given = given_.find(name);
    Landmark& point = out_.points[i];
    point.place = given != given_.end() ? given->second : place;
    point.confidence = given != given_.end() ? 1 : confidence;
    point.source = given != given_.end() ? "given" : source;
  }
  const Vector3d& at(const std::string& name) const { return out_.at(name); }

  /// the skin at (x, y), or the middle of the face's depth where there is none
  Vector3d skin_at(double x, double y, double otherwise) const { return {x, y, head_.front(x, y).value_or(otherwise)}; }

  Status find_profile();
  Status find_eyes();
  Status find_mouth();
  void find_sides();
  Eyeball guessed_eye(int side) const;
  bool open_lids(int side);
  void closed_lids(int side);

  const Head& head_;
  const std::map<std::string, Vector3d>& given_;
  Landmarks out_;
};

Status Finder::find_profile() {
  constexpr double step = 0.0005;
  const double top = head_.top();
  const double x = head_.middle();
  const Relief line = vertical(head_, x, top - 0.005, top - 0.29, step);
  const auto point = [&](int i) { return Vector3d(x, line.at[i], line.z[i]); };

  // the nose is the foremost point of the middle plane that stands out from the cheeks beside it
  const auto tip_given = given_.find("nose_tip");
  const double low = line.size() > 0 ? line.at.back() : top, tall = top - low;
  const double highest = head_.closed() ? top - 0.05 : top - 0.15 * tall;
  const double lowest = head_.closed() ? top - 0.20 : low + 0.35 * tall;
  int tip = tip_given != given_.end() ? line.index(tip_given->second.y()) : foremost(line, lowest, highest);
  if (tip < 0) return missing("the nose was not found: the middle plane x = ", x, " meets no skin");
  const double prominence = line.z[tip] - std::max(head_.front(x - 0.035, line.at[tip]).value_or(-1),
                                                   head_.front(x + 0.035, line.at[tip]).value_or(-1));
  if (tip_given == given_.end() && prominence < 0.010)
    return missing("the nose was not found: the foremost point of the middle plane, at height ", line.at[tip],
                   " m, stands out by ", prominence * 1000,
                   " mm from the cheeks, at least 10 are needed; does the head face +Z?");
  put("nose_tip", point(tip), confidence_of(prominence, 0.02), "profile");
  const double y = line.at[tip];

  // the cleft of the closed mouth is the first sharp dip below the nose: that above the chin may be as deep
  const auto stomion_given = given_.find("stomion");
  constexpr double sharp = 0.0035;
  double deepest = 0;
  std::vector<double> dip(line.size(), 0);
  for (int i = 0; i < line.size(); ++i)
    if (line.at[i] < y - 0.016 && line.at[i] > y - 0.060) deepest = std::max(deepest, dip[i] = notch(line, i, sharp));
  int cleft = -1;
  for (int i = 1; i + 1 < line.size() && cleft < 0; ++i)
    if (dip[i] > 0.4 * deepest && dip[i] >= dip[i + 1]) cleft = i;
  if (stomion_given != given_.end()) cleft = line.index(stomion_given->second.y());
  const double depth = cleft < 0 ? 0 : notch(line, cleft, 0.007);
  if (stomion_given == given_.end() && depth < 0.0005)
    return missing("the lips were not found: between 16 and 60 mm below the nose the deepest dip of the profile is ",
                   std::max(0.0, depth) * 1000, " mm, at least 0.5 are needed; give the landmark stomion");
  const double mouth = line.at[cleft];
  const int upper = foremost(line, mouth + 0.001, mouth + 0.013);
  const int lower = foremost(line, mouth - 0.014, mouth - 0.001);
  if (upper < 0 || lower < 0) return missing("the lips were not found: the profile is open beside the mouth");
  put("upper_lip", point(upper), 1, "profile");
  put("lower_lip", point(lower), 1, "profile");
  // the lips meet behind their foremost points, however far the ray goes into the mouth
  put("stomion", {x, mouth, std::max(line.z[cleft], std::min(line.z[upper], line.z[lower]) - 0.006)},
      confidence_of(depth, 0.002), "profile");

  const Bulge under_nose = bulge(line, tip, upper, -1);
  if (under_nose.index < 0) return missing("the base of the nose was not found: no hollow between nose and upper lip");
  put("subnasale", point(under_nose.index), confidence_of(under_nose.height, 0.003), "profile");

  // the chin's lowest point: where the profile, seen from the front, ends or falls far back
  int last = lower;
  while (last + 1 < line.size() && line.at[last + 1] > mouth - 0.075 && line.z[last + 1] > line.z[lower] - 0.035 &&
         line.at[last] - line.at[last + 1] < 2 * step)
    ++last;
  const int chin = foremost(line, line.at[last], mouth - 0.024);
  if (chin < 0 || line.at[last] > mouth - 0.025)
    return missing("the chin was not found: the profile ends ", (mouth - line.at[last]) * 1000,
                   " mm below the mouth, at least 25 are needed");
  put("chin", point(chin), 1, "profile");
  const Bulge fold = bulge(line, lower, chin, -1);
  const int hollow = fold.index < 0 ? (lower + chin) / 2 : fold.index;
  put("labiomental", point(hollow), confidence_of(fold.height, 0.003), "profile");
  // menton: farthest along the direction down and slightly back
  int menton = chin;
  const auto lowness = [&](int i) { return -line.at[i] + 0.35 * line.z[i]; };
  for (int i = chin; i <= last; ++i)
    if (lowness(i) > lowness(menton)) menton = i;
  put("menton", point(menton), 0.9, "profile");

  const int high = std::min(line.index(y + 0.085), tip);
  const Bulge root = bulge(line, high, tip, -1);
  if (root.index < 0 || line.at[root.index] - y < 0.02)
    return missing("the root of the nose was not found: no hollow above the nose");
  put("nasion", point(root.index), confidence_of(root.height, 0.004), "profile");
  const Bulge brow = bulge(line, line.index(line.at[root.index] + 0.045), root.index, +1);
  const int glabella = brow.index < 0 ? line.index(line.at[root.index] + 0.015) : brow.index;
  put("glabella", point(glabella), confidence_of(brow.height, 0.002), brow.index < 0 ? "proportion" : "profile");
  return success();
}

/// Eyes of average people: centres 63 mm apart (ANSUR interpupillary, from memory), just below the nasion, the front of
/// the ball a lid's thickness under the skin.
Eyeball Finder::guessed_eye(int side) const {
  const double scale = (at("nasion").y() - at("stomion").y()) / 0.072;
  Eyeball eye;
  eye.radius = 0.012 * scale;
  const double x = head_.middle() + (side == 0 ? 1 : -1) * 0.0315 * scale, y = at("nasion").y() - 0.005 * scale;
  eye.centre = skin_at(x, y, at("nasion").z() - 0.02) - Vector3d(0, 0, eye.radius + 0.002);
  return eye;
}

/// The aperture of an eye: rays from its centre that leave the ball without passing through skin.
bool Finder::open_lids(int side) {
  const Eyeball& eye = out_.eyes[side];
  std::vector<Vector3d> upper, lower;
  constexpr double degree = M_PI / 180, across = 2.5 * degree, up = 1.2 * degree, widest = 70 * degree,
                   highest = 50 * degree;
  const auto way = [](double azimuth, double elevation) {
    return Vector3d(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                    std::cos(azimuth) * std::cos(elevation));
  };
  for (double azimuth = -widest; azimuth <= widest; azimuth += across) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (double elevation = -highest; elevation < highest; elevation += up) {
      // a hole in the skin in front of the orbit is an opening too, as is a pocket behind the lids
      if (head_.outermost(eye.centre, way(azimuth, elevation)).value_or(0) > 1.01 * eye.radius) continue;
      low = std::min(low, elevation);
      high = std::max(high, elevation);
    }
    if (high - low < up) continue;
    const auto margin = [&](double elevation, double out) {
      const double skin = head_.outermost(eye.centre, way(azimuth, elevation + out)).value_or(eye.radius);
      return Vector3d(eye.centre + std::clamp(skin, eye.radius, 1.15 * eye.radius) * way(azimuth, elevation));
    };
    upper.push_back(margin(high + up / 2, 2 * up));
    lower.push_back(margin(low - up / 2, -2 * up));
  }
  if (upper.size() < 12) return false;
  // the canthi close the two margins
  const Vector3d right = (upper.front() + lower.front()) / 2 + (upper.front() - upper[1]) / 2;
  const Vector3d left = (upper.back() + lower.back()) / 2 + (upper.back() - upper[upper.size() - 2]) / 2;
  for (auto* margin : {&upper, &lower}) {
    margin->insert(margin->begin(), right);
    margin->push_back(left);
  }
  out_.upper_lid[side] = upper;
  out_.lower_lid[side] = lower;
  return true;
}

/// Shut or unseen lids: a cut across the front of the ball, 30 mm long (palpebral fissure, from memory), bent down.
void Finder::closed_lids(int side) {
  const Eyeball& eye = out_.eyes[side];
  const double half = 1.2 * eye.radius;
  out_.upper_lid[side].clear();
  for (int i = 0; i <= 20; ++i) {
    const double s = -1 + 0.1 * i;
    const double y = eye.centre.y() - 0.25 * eye.radius * (1 - s * s);
    out_.upper_lid[side].push_back(skin_at(eye.centre.x() + half * s, y, eye.centre.z()));
  }
  out_.lower_lid[side] = out_.upper_lid[side];
}

Status Finder::find_eyes() {
  for (int side : {0, 1}) {
    const std::string who = side == 0 ? "left_" : "right_";
    const bool part = head_.eyeballs()[side].has_value();
    out_.eyes[side] = part ? *head_.eyeballs()[side] : guessed_eye(side);
    // a guessed eye is open only where the skin has a hole or a pocket in its middle
    const Vector3d& centre = out_.eyes[side].centre;
    const bool pocket = part || head_.front(centre.x(), centre.y()).value_or(-HUGE_VAL) < centre.z();
    const bool open = pocket && open_lids(side);
    if (!open) closed_lids(side);
    const auto &upper = out_.upper_lid[side], &lower = out_.lower_lid[side];
    const char* source = part ? "eyeball" : open ? "opening" : "proportion";
    const double sure = part && open ? 1 : open ? 0.8 : 0.5;
    // the person's left eye has its inner corner on the right end
    const Vector3d &right = upper.front(), &left = upper.back();
    put(who + "inner_canthus", side == 0 ? right : left, sure, source);
    put(who + "outer_canthus", side == 0 ? left : right, sure, source);
    put(who + "upper_lid", upper[upper.size() / 2], sure, source);
    put(who + "lower_lid", lower[lower.size() / 2], sure, source);
    for (auto* margin : {&out_.upper_lid[side], &out_.lower_lid[side]}) {
      // corners that were given move the ends of the margins
      const Vector3d to_right = at(who + (side == 0 ? "inner" : "outer") + "_canthus") - margin->front();
      const Vector3d to_left = at(who + (side == 0 ? "outer" : "inner") + "_canthus") - margin->back();
      for (std::size_t i = 0; i < margin->size(); ++i) {
        const double s = double(i) / double(margin->size() - 1);
        (*margin)[i] += (1 - s) * to_right + s * to_left;
      }
    }
  }
  const double apart = out_.eyes[0].centre.x() - out_.eyes[1].centre.x();
  if (!(apart > 0.045 && apart < 0.085))
    return missing("eyes must be 45 to 85 mm apart, are ", apart * 1000, "; is the length in metres?");
  for (const Eyeball& eye : out_.eyes)
    if (std::abs(eye.centre.y() - at("nasion").y()) > 0.030)
      return missing("an eye lies ", std::abs(eye.centre.y() - at("nasion").y()) * 1000,
                     " mm above or below the root of the nose, at most 30 is plausible");
  return success();
}

Status Finder::find_mouth() {
  const Vector3d stomion = at("stomion");
  constexpr double dx = 0.001, dy = 0.0004;
  const double widest = 0.040;
  std::array<std::vector<Vector3d>, 2> half;
  std::array<double, 2> sure = {0.5, 0.5};
  for (int side : {0, 1}) {
    const double sign = side == 0 ? 1 : -1;
    const std::string name = side == 0 ? "left_mouth_corner" : "right_mouth_corner";
    double y = stomion.y();
    std::vector<Vector3d>& cleft = half[side];
    const auto given = given_.find(name);
    const double end = given != given_.end() ? std::abs(given->second.x() - stomion.x()) : widest;
    double depth = 0;
    for (double x = dx; x < end; x += dx) {
      const Relief line = vertical(head_, stomion.x() + sign * x, y + 0.012, y - 0.012, dy);
      int best = -1;
      for (int i = 0; i < line.size(); ++i)
        if (std::abs(line.at[i] - y) < 0.0018 && (best < 0 || notch(line, i, 0.006) > notch(line, best, 0.006)))
          best = i;
      depth = best < 0 ? 0 : notch(line, best, 0.006);
      if (depth < 0.0006 && given == given_.end()) break;
      if (best < 0) break;
      y = 0.5 * y + 0.5 * line.at[best];
      double lips = HUGE_VAL;
      for (int d : {-1, 1}) {
        const int k = foremost(line, d > 0 ? line.at[best] + 0.0005 : line.at[best] - 0.005,
                               d > 0 ? line.at[best] + 0.005 : line.at[best] - 0.0005);
        if (k >= 0) lips = std::min(lips, line.z[k]);
      }
      cleft.push_back({stomion.x() + sign * x, line.at[best], std::max(line.z[best], lips - 0.006)});
    }
    const double width = cleft.empty() ? 0 : std::abs(cleft.back().x() - stomion.x());
    if (given == given_.end() && (width < 0.014 || width > widest - 1.5 * dx)) {
      // the corners lie below the inner edges of the irises (Wilkinson et al. 2003, from memory)
      const double x = 0.8 * std::abs(out_.eyes[side].centre.x() - stomion.x());
      cleft.clear();
      for (double s = 0.1; s <= 1.001; s += 0.1)
        cleft.push_back(skin_at(stomion.x() + sign * s * x, stomion.y(), stomion.z()));
    } else {
      sure[side] = 0.9;
    }
    if (cleft.size() < 2) return missing(name, " was not found: the cleft between the lips ends at once");
    // the skin at the corner itself
    Vector3d corner = cleft.back() + Vector3d(sign * dx, 0, 0);
    corner.z() = head_.front(corner.x(), corner.y()).value_or(cleft.back().z());
    put(name, corner, sure[side], sure[side] > 0.5 ? "cleft" : "proportion");
    cleft.push_back(at(name));
  }
  out_.mouth.assign(half[1].rbegin(), half[1].rend());
  out_.mouth.push_back(stomion);
  out_.mouth.insert(out_.mouth.end(), half[0].begin(), half[0].end());
  const double width = out_.mouth.back().x() - out_.mouth.front().x();
  if (!(width > 0.028 && width < 0.085))
    return missing("the mouth must be 28 to 85 mm wide, is ", width * 1000, " mm; give the mouth corners");
  return success();
}

/// Points at the sides of the face, from relief where there is one and from proportion else.
void Finder::find_sides() {
  const Vector3d tip = at("nose_tip"), base = at("subnasale"), stomion = at("stomion"), nasion = at("nasion");
  const double height = nasion.y() - at("menton").y();  // about 0.115 m in adults
  for (int side : {0, 1}) {
    const double sign = side == 0 ? 1 : -1;
    const std::string who = side == 0 ? "left_" : "right_";
    const Vector3d inner = at(who + "inner_canthus"), outer = at(who + "outer_canthus");
    const Eyeball& eye = out_.eyes[side];

    // the wing of the nose ends in the crease between tip and cheek
    const double wing_y = base.y() + 0.75 * (tip.y() - base.y());
    Relief across;
    for (double x = 0.004; x < 0.036; x += 0.0005)
      if (const auto z = head_.front(head_.middle() + sign * x, wing_y)) {
        across.at.push_back(x);
        across.z.push_back(*z);
      }
    const Bulge crease = bulge(across, 0, across.size() - 1, -1);
    const double wing_x = crease.index < 0 ? 0.018 : across.at[crease.index] - 0.001;
    put(who + "nose_wing", skin_at(head_.middle() + sign * wing_x, wing_y, base.z()),
        crease.index < 0 ? 0.5 : confidence_of(crease.height, 0.006), crease.index < 0 ? "proportion" : "relief");

    // the brow is the ridge above the eye
    const double at_x[3] = {inner.x() + 0.1 * (inner.x() - eye.centre.x()), eye.centre.x(), outer.x()};
    const char* places[3] = {"brow_inner", "brow_middle", "brow_outer"};
    for (int k = 0; k < 3; ++k) {
      const Relief line = vertical(head_, at_x[k], eye.centre.y() + 0.042, eye.centre.y() + 0.008, 0.0005);
      const Bulge ridge = bulge(line, 0, line.size() - 1, +1);
      const bool seen = ridge.index >= 0 && ridge.height > 0.0007;
      const double y = seen ? line.at[ridge.index] : eye.centre.y() + 0.021;
      put(who + places[k], skin_at(at_x[k], y, eye.centre.z()), seen ? confidence_of(ridge.height, 0.004) : 0.5,
          seen ? "relief" : "proportion");
    }

    // widest point of the head between brow and mouth, beyond the face: the ear's rim
    Vector3d ear(0, 0, -HUGE_VAL);
    double out = 0;
    for (Eigen::Index v = 0; v < head_.skin().V.rows(); ++v) {
      const Vector3d p = head_.skin().V.row(v).transpose().cast<double>();
      if (p.y() > stomion.y() - 0.01 && p.y() < nasion.y() + 0.03 && p.z() < outer.z() - 0.03 &&
          sign * (p.x() - head_.middle()) > out) {
        out = sign * (p.x() - head_.middle());
        ear = p;
      }
    }
    const bool seen = out > 0.055 && head_.closed();
    if (!seen) ear = Vector3d(head_.middle() + sign * 0.075, nasion.y() - 0.015, nasion.z() - 0.105);
    put(who + "ear", ear, seen ? 0.8 : 0.5, seen ? "relief" : "proportion");

    // the condyle lies before the ear canal, which is about 20 mm in front of the rim at the height of the nose
    const double scale = height / 0.115;
    const Vector3d joint(head_.middle() + sign * 0.050 * scale, 0.4 * nasion.y() + 0.6 * base.y() + 0.004,
                         ear.z() + (seen ? 0.030 : 0.014) * scale);
    put(who + "jaw_joint", joint, 0.5, "proportion");

    const auto side_skin = [&](double y, double z, double otherwise) {
      const auto reach = head_.outermost({head_.middle(), y, z}, Vector3d(sign, 0, 0));
      return Vector3d(head_.middle() + sign * reach.value_or(otherwise), y, z);
    };
    put(who + "jaw_angle", side_skin(stomion.y() - 0.012 * scale, joint.z() + 0.004, 0.055), 0.5, "proportion");
    put(who + "cheekbone", skin_at(outer.x() + sign * 0.004, 0.45 * outer.y() + 0.55 * wing_y, outer.z()), 0.6,
        "proportion");
  }
}

}  // namespace

const std::vector<std::string> landmark_names = [] {
  std::vector<std::string> names = {"glabella", "nasion",    "nose_tip",    "subnasale", "upper_lip",
                                    "stomion",  "lower_lip", "labiomental", "chin",      "menton"};
  for (const char* who : {"left_", "right_"})
    for (const char* name : {"mouth_corner", "nose_wing", "inner_canthus", "outer_canthus", "upper_lid", "lower_lid",
                             "brow_inner", "brow_middle", "brow_outer", "cheekbone", "jaw_angle", "jaw_joint", "ear"})
      names.push_back(std::string(who) + name);
  return names;
}();

const Vector3d& Landmarks::at(const std::string& name) const {
  return points[std::find(landmark_names.begin(), landmark_names.end(), name) - landmark_names.begin()].place;
}

Result<Landmarks> find_landmarks(const Head& head, const std::map<std::string, Vector3d>& given) {
  return Finder(head, given).find();
}

}  // namespace face
