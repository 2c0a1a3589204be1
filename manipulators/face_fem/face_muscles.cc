#include "manipulators/face_fem/face_muscles.h"

#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/warp.h"

namespace face {
namespace {

using Eigen::Vector3d;

/// Largest stress of a muscle, pascals: as in the published face model.
constexpr double stress = 100e3;

/// A landmark of the published face mesh (newface.node of the ArtiSynth models, after Nazari et al. 2010), millimetres,
/// x to the left, y up, z forward; found on its skin by find_landmarks(). Paired ones are given for the left.
struct Anchor {
  const char* name;
  double x, y, z;
};
constexpr Anchor anchors[] = {
    {"glabella", 0, -4.4, 92.0},          {"nasion", 0, -17.4, 84.8},           {"nose_tip", 0, -58.4, 94.8},
    {"subnasale", 0, -65.9, 78.9},        {"upper_lip", 0, -77.4, 80.3},        {"stomion", 0, -83.4, 72.0},
    {"lower_lip", 0, -89.9, 76.6},        {"labiomental", 0, -104.9, 68.2},     {"chin", 0, -110.9, 68.2},
    {"menton", 0, -123.9, 57.5},          {"mouth_corner", 24.0, -82.6, 61.7},  {"nose_wing", 13.5, -60.3, 73.6},
    {"inner_canthus", 13.5, -22.8, 69.3}, {"outer_canthus", 41.3, -22.6, 62.4}, {"cheekbone", 45.3, -43.3, 58.7},
};

/// A fibre of the same source (muscles.node and face_muscles_topology.mac), ends in the same frame; `origin_bone` says
/// that the first end lies in bone, which is read from anatomy.
struct Fibre {
  const char* muscle;
  double ox, oy, oz, ix, iy, iz;
};
constexpr Fibre fibres[] = {
    {"zygomaticus_major", 51.2, -30.9, 42.2, 30.0, -74.0, 47.9},
    {"risorius", 47.5, -65.1, 21.9, 28.3, -82.3, 56.8},
    {"levator_anguli", 22.5, -44.9, 58.9, 20.0, -68.1, 66.3},
    {"levator_anguli", 32.3, -45.5, 58.7, 27.5, -68.3, 60.7},
    {"levator_labii_alaeque", 17.6, -33.8, 65.9, 22.9, -69.1, 64.8},
    {"levator_labii_alaeque", 17.6, -33.8, 65.9, 10.7, -60.4, 64.7},
    {"depressor_anguli", 18.3, -109.4, 45.3, 29.9, -86.0, 46.0},
    {"depressor_anguli", 29.6, -102.8, 39.1, 29.9, -86.0, 46.0},
    {"depressor_labii", 5.4, -113.1, 57.5, 2.5, -98.3, 67.7},
    {"depressor_labii", 20.0, -103.5, 46.6, 16.7, -94.7, 59.4},
    {"mentalis", 1.9, -103.0, 58.1, 1.5, -116.0, 62.9},
    {"mentalis", 6.6, -104.3, 57.6, 4.0, -116.0, 62.9},
    {"buccinator", 36.9, -49.6, 26.4, 23.5, -71.9, 55.1},
    {"buccinator", 35.7, -70.7, 28.6, 22.7, -86.9, 54.0},
};

/// Rings of orbicularis oris of the same source: midline above and below, corner; same frame.
struct Ring {
  const char* muscle;
  Vector3d upper, lower, corner;
};
const Ring rings[] = {
    {"orbicularis_oris_marginal", {0, -76.4, 76.6}, {0, -91.4, 73.0}, {22, -83, 56}},
    {"orbicularis_oris_peripheral", {0, -69.5, 69.4}, {0, -96.0, 66.3}, {24.8, -84.2, 54.6}},
};

/// An end placed by anatomy: a share of the way between two landmarks, then millimetres outward and up on the chart.
struct Place {
  const char* from;
  const char* to;
  double share, out, up;
  bool bone;
};
struct Course {
  const char* muscle;
  Place origin, insertion;
};
/// After general anatomical description (Gray's Anatomy), from memory; paired, for the left.
constexpr Course courses[] = {
    // from the galea down to the skin of the brow
    {"frontalis_medial",
     {"brow_inner", "brow_middle", 0.0, -2, 34, true},
     {"brow_inner", "brow_middle", -0.1, 0, 3, false}},
    {"frontalis_medial",
     {"brow_inner", "brow_middle", 0.4, 0, 35, true},
     {"brow_inner", "brow_middle", 0.4, 0, 3, false}},
    {"frontalis_medial",
     {"brow_inner", "brow_middle", 0.8, 0, 36, true},
     {"brow_inner", "brow_middle", 0.9, 0, 3, false}},
    {"frontalis_medial",
     {"brow_inner", "brow_middle", 0.2, -2, 34, true},
     {"brow_inner", "brow_middle", 0.1, 0, 10, false}},
    {"frontalis_medial",
     {"brow_inner", "brow_middle", 0.7, -2, 34, true},
     {"brow_inner", "brow_middle", 0.7, 0, 10, false}},
    {"frontalis_lateral",
     {"brow_middle", "brow_outer", 0.2, 1, 36, true},
     {"brow_middle", "brow_outer", 0.1, 0, 3, false}},
    {"frontalis_lateral",
     {"brow_middle", "brow_outer", 0.6, 2, 36, true},
     {"brow_middle", "brow_outer", 0.5, 0, 3, false}},
    {"frontalis_lateral",
     {"brow_middle", "brow_outer", 1.0, 3, 35, true},
     {"brow_middle", "brow_outer", 0.9, 0, 4, false}},
    {"frontalis_lateral",
     {"brow_middle", "brow_outer", 0.4, 2, 36, true},
     {"brow_middle", "brow_outer", 0.3, 0, 10, false}},
    {"frontalis_lateral",
     {"brow_middle", "brow_outer", 0.9, 3, 35, true},
     {"brow_middle", "brow_outer", 0.8, 0, 11, false}},
    // from the medial end of the superciliary arch to the skin of the middle of the brow
    {"corrugator", {"nasion", "brow_inner", 0.65, 0, -1, true}, {"brow_inner", "brow_middle", 0.2, 0, 1, false}},
    {"corrugator", {"nasion", "brow_inner", 0.65, 0, -1, true}, {"brow_inner", "brow_middle", 0.55, 0, 2, false}},
    {"corrugator", {"nasion", "brow_inner", 0.65, 0, 1, true}, {"brow_inner", "brow_middle", 0.9, 0, 3, false}},
    // from the rim of the orbit above the inner canthus to the head of the brow
    {"depressor_supercilii",
     {"inner_canthus", "nasion", 0.35, 0, 2, true},
     {"brow_inner", "brow_middle", 0.1, 0, 1, false}},
    // from the zygoma, medial to the major, to the skin of the upper lip
    {"zygomaticus_minor",
     {"cheekbone", "lower_lid", 0.15, 0, 3, true},
     {"mouth_corner", "nose_wing", 0.25, 1, 0, false}},
    {"zygomaticus_minor",
     {"cheekbone", "lower_lid", 0.15, 0, 3, true},
     {"mouth_corner", "nose_wing", 0.30, -3, 0, false}},
    // from below the rim of the orbit to the upper lip
    {"levator_labii",
     {"lower_lid", "cheekbone", 0.45, -5, -2, true},
     {"mouth_corner", "nose_wing", 0.35, -2, 0, false}},
    {"levator_labii",
     {"lower_lid", "cheekbone", 0.45, -3, -2, true},
     {"mouth_corner", "nose_wing", 0.35, -5, 0, false}},
    {"levator_labii",
     {"lower_lid", "cheekbone", 0.45, -1, -2, true},
     {"mouth_corner", "nose_wing", 0.35, -8, 0, false}},
    // from the chest over the border of the jaw to cheek and corner of the mouth
    {"platysma", {"jaw_angle", "menton", 0.35, 8, -45, true}, {"jaw_angle", "menton", 0.35, 0, 12, false}},
    {"platysma", {"jaw_angle", "menton", 0.55, 8, -45, true}, {"jaw_angle", "menton", 0.55, 0, 10, false}},
    {"platysma", {"jaw_angle", "menton", 0.60, 6, -45, true}, {"mouth_corner", "jaw_angle", 0.15, 0, -6, false}},
};

/// Cross-sections in mm2, all strands of one muscle together. Order of size by ultrasound and magnetic resonance; the
/// numbers are from memory and rounded.
struct Section {
  const char* muscle;
  double square_millimetres;
};
constexpr Section sections[] = {
    {"frontalis_medial", 35},
    {"frontalis_lateral", 35},
    {"corrugator", 20},
    {"depressor_supercilii", 10},
    {"orbicularis_oculi_orbital", 8},
    {"orbicularis_oculi_palpebral", 6},
    {"levator_palpebrae", 5},
    {"zygomaticus_major", 40},
    {"zygomaticus_minor", 10},
    {"levator_labii_alaeque", 20},
    {"levator_labii", 15},
    {"levator_anguli", 20},
    {"depressor_anguli", 25},
    {"depressor_labii", 15},
    {"risorius", 10},
    {"buccinator", 25},
    {"mentalis", 12},
    {"platysma", 40},
    {"procerus", 15},
    {"orbicularis_oris_marginal", 7},
    {"orbicularis_oris_peripheral", 16},
};

/// Puts points of the face at their depth in the tissue.
class Placer {
 public:
  Placer(const Landmarks& marks, const FaceSheet& sheet, const FaceTissue& tissue)
      : marks_(marks), sheet_(sheet), tissue_(tissue) {}

  /// bone and skin on a ray
  struct Bounds {
    double inner, skin;
  };
  Bounds bounds(const ChartPoint& c, CutSide side, int row) const {
    const SheetPlace at = locate(sheet_, c, side, row);
    const std::array<int, 4> q = sheet_.quad(at.i, at.j);
    const double w[4] = {(1 - at.u) * (1 - at.v), at.u * (1 - at.v), at.u * at.v, (1 - at.u) * at.v};
    Bounds b = {0, 0};
    for (int k = 0; k < 4; ++k) {
      const Vector3d from = sheet_.chart.origin(sheet_.stacks[q[k]].height);
      const auto& stack = tissue_.node[q[k]];
      b.inner += w[k] * (tissue_.model.nodes[stack.front()] - from).norm();
      b.skin += w[k] * (tissue_.model.nodes[stack.back()] - from).norm();
    }
    return b;
  }

  Vector3d on_bone(const Vector3d& p) const {
    ChartPoint c = sheet_.chart.of(p);
    c.radius = bounds(c, CutSide::any, 0).inner;
    return sheet_.chart.point(c);
  }

  /// A place in the tissue and the sphere round it: kept within the sheet and off bone and skin.
  struct Bed {
    Vector3d place;
    double radius;
  };
  Bed in_tissue(const Vector3d& p, CutSide side = CutSide::any, int row = 0) const {
    ChartPoint c = sheet_.chart.of(p);
    const SheetPlace at = locate(sheet_, c, side, row);
    // pulled onto the sheet when it lies beside it, and a little away from a cut
    const std::array<int, 4> q = sheet_.quad(at.i, at.j);
    const double v = side == CutSide::above && at.j == row       ? std::max(at.v, 0.5)
                     : side == CutSide::below && at.j + 1 == row ? std::min(at.v, 0.5)
                                                                 : at.v;
    const double w[4] = {(1 - at.u) * (1 - v), at.u * (1 - v), at.u * v, (1 - at.u) * v};
    if (at.miss > 0 || v != at.v) {
      c.angle = c.height = 0;
      for (int k = 0; k < 4; ++k) {
        c.angle += w[k] * sheet_.stacks[q[k]].angle;
        c.height += w[k] * sheet_.stacks[q[k]].height;
      }
    }
    const Bounds b = bounds(c, side, row);
    const double thickness = b.skin - b.inner;
    c.radius = std::clamp(c.radius, b.inner + 0.40 * thickness, b.inner + 0.70 * thickness);
    return {sheet_.chart.point(c), std::clamp(0.6 * thickness, 0.0015, 0.0055)};
  }

  /// a point of the skin moved on the chart, metres
  Vector3d shifted(const Vector3d& p, double across, double up) const {
    ChartPoint c = sheet_.chart.of(p);
    c.angle += across / FaceChart::nominal;
    c.height += up;
    return sheet_.chart.point(c);
  }

  const Landmarks& marks() const { return marks_; }
  const FaceSheet& sheet() const { return sheet_; }
  double scale() const { return (marks_.at("nasion").y() - marks_.at("menton").y()) / 0.105; }

 private:
  const Landmarks& marks_;
  const FaceSheet& sheet_;
  const FaceTissue& tissue_;
};

bool is_paired(const std::string& landmark) {
  return std::find(landmark_names.begin(), landmark_names.end(), "left_" + landmark) != landmark_names.end();
}

std::string full_name(const std::string& name, int side) {
  return is_paired(name) ? (side == 0 ? "left_" : "right_") + name : name;
}

Warp warp_to(const Landmarks& marks) {
  std::vector<Vector3d> from, to;
  for (const Anchor& a : anchors)
    for (int side : {0, 1}) {
      if (!is_paired(a.name) && side == 1) continue;
      from.push_back(1e-3 * Vector3d(side == 0 ? a.x : -a.x, a.y, a.z));
      to.push_back(marks.at(full_name(a.name, side)));
    }
  return Warp(from, to);
}

Strand strand(const Placer& placer, const Vector3d& origin, bool origin_bone, const Vector3d& insertion) {
  Strand s;
  if (origin_bone) {
    s.origin = placer.on_bone(origin);
  } else {
    const Placer::Bed bed = placer.in_tissue(origin);
    s.origin = bed.place;
    s.origin_radius = bed.radius;
  }
  const Placer::Bed bed = placer.in_tissue(insertion);
  s.insertion = bed.place;
  s.insertion_radius = bed.radius;
  return s;
}

/// The fibres of one muscle, and half-way between each and the next one more, so that the pull is spread; those that
/// end in the modiolus are led on to it.
std::vector<Strand> published(const Placer& placer, const Warp& warp, const std::string& muscle, int side) {
  struct Ends {
    Vector3d origin, insertion;
  };
  std::vector<Ends> all;
  const double sign = side == 0 ? 1 : -1;
  const bool to_modiolus = muscle == "zygomaticus_major" || muscle == "depressor_anguli";
  const Vector3d modiolus =
      placer.shifted(placer.marks().at(full_name("mouth_corner", side)), sign * 4e-3 * placer.scale(), 0);
  for (const Fibre& f : fibres) {
    if (muscle != f.muscle) continue;
    const Vector3d origin = warp(1e-3 * Vector3d(sign * f.ox, f.oy, f.oz));
    const Vector3d insertion = warp(1e-3 * Vector3d(sign * f.ix, f.iy, f.iz));
    if (!all.empty()) all.push_back({(all.back().origin + origin) / 2, (all.back().insertion + insertion) / 2});
    all.push_back({origin, insertion});
    if (to_modiolus) all.push_back({origin, modiolus});
  }
  std::vector<Strand> strands;
  for (const Ends& e : all) strands.push_back(strand(placer, e.origin, true, e.insertion));
  return strands;
}

std::vector<Strand> anatomical(const Placer& placer, const std::string& muscle, int side) {
  std::vector<Strand> strands;
  const auto place = [&](const Place& p) {
    const Vector3d from = placer.marks().at(full_name(p.from, side)), to = placer.marks().at(full_name(p.to, side));
    const double scale = 1e-3 * placer.scale();
    return placer.shifted(from + p.share * (to - from), (side == 0 ? 1 : -1) * p.out * scale, p.up * scale);
  };
  for (const Course& c : courses)
    if (muscle == c.muscle) strands.push_back(strand(placer, place(c.origin), c.origin.bone, place(c.insertion)));
  return strands;
}

/// Strands from each bed to the next, tension along the chain; `open` chains hang at bone at both ends.
std::vector<Strand> chain(const std::vector<Placer::Bed>& beds, bool open) {
  std::vector<Strand> strands;
  const std::size_t n = beds.size();
  for (std::size_t k = 0; k + (open ? 1 : 0) < n; ++k) {
    const Placer::Bed &a = beds[k], &b = beds[(k + 1) % n];
    Strand s;
    s.origin = a.place;
    s.insertion = b.place;
    s.origin_radius = open && k == 0 ? 0 : a.radius;
    s.insertion_radius = open && k + 2 == n ? 0 : b.radius;
    strands.push_back(s);
  }
  return strands;
}

/// A closed ring round the mouth through the warped midline and corner points of the published one.
std::vector<Strand> mouth_ring(const Placer& placer, const Warp& warp, const Ring& ring) {
  const FaceChart& chart = placer.sheet().chart;
  const auto at = [&](Vector3d p, double sign) {
    p.x() *= sign;
    return chart.of(warp(1e-3 * p));
  };
  const ChartPoint upper = at(ring.upper, 1), lower = at(ring.lower, 1);
  const int row = placer.sheet().mouth.row;
  std::vector<Placer::Bed> beds;
  constexpr int count = 12;
  for (int k = 0; k < count; ++k) {
    const double turn = 2 * M_PI * k / count, c = std::cos(turn), s = std::sin(turn);
    const ChartPoint corner = at(ring.corner, c < 0 ? -1 : 1), middle = s >= 0 ? upper : lower;
    ChartPoint p;
    p.angle = middle.angle + std::abs(c) * (corner.angle - middle.angle);
    p.height = corner.height + std::abs(s) * (middle.height - corner.height);
    p.radius = corner.radius + std::abs(s) * (middle.radius - corner.radius);
    const CutSide side = std::abs(s) < 0.1 ? CutSide::any : s > 0 ? CutSide::above : CutSide::below;
    beds.push_back(placer.in_tissue(chart.point(p), side, row));
  }
  return chain(beds, false);
}

/// The orbital part: two arcs, each from the rim of the orbit at the inner canthus once round the eye and back to it.
std::vector<Strand> orbital_rings(const Placer& placer, int side) {
  const double sign = side == 0 ? 1 : -1, scale = 1e-3 * placer.scale();
  const Eyeball& eye = placer.marks().eyes[side];
  const Vector3d front = eye.centre + Vector3d(0, 0, eye.radius);
  const Vector3d anchor = placer.marks().at(full_name("inner_canthus", side));
  const Placer::Bed bone = {placer.on_bone(placer.shifted(anchor, -5 * sign * scale, 0)), 0};
  std::vector<Strand> strands;
  for (const Eigen::Vector2d& half : {Eigen::Vector2d(22, 15), Eigen::Vector2d(28, 21)}) {
    std::vector<Placer::Bed> beds = {bone};
    for (double degrees = 150; degrees >= -150; degrees -= 25) {
      const double t = degrees * M_PI / 180;
      beds.push_back(placer.in_tissue(
          placer.shifted(front, sign * half.x() * scale * std::cos(t), half.y() * scale * std::sin(t))));
    }
    beds.push_back(bone);
    const std::vector<Strand> arc = chain(beds, true);
    strands.insert(strands.end(), arc.begin(), arc.end());
  }
  return strands;
}

/// The palpebral part: an arc in each lid, both from the inner canthus to the outer one, where they hang at bone.
std::vector<Strand> palpebral_arcs(const Placer& placer, int side) {
  const Landmarks& marks = placer.marks();
  const int row = placer.sheet().eyes[side].row;
  const double scale = 1e-3 * placer.scale();
  std::vector<Strand> strands;
  for (bool above : {true, false}) {
    const auto& margin = above ? marks.upper_lid[side] : marks.lower_lid[side];
    std::vector<Placer::Bed> beds;
    beds.push_back({placer.on_bone(margin.front()), 0});
    for (double s = 0.12; s < 0.9; s += 0.19) {
      const Vector3d& p = margin[std::size_t(s * double(margin.size() - 1))];
      beds.push_back(placer.in_tissue(placer.shifted(p, 0, (above ? 3.5 : -3) * scale),
                                      above ? CutSide::above : CutSide::below, row));
    }
    beds.push_back({placer.on_bone(margin.back()), 0});
    const std::vector<Strand> arc = chain(beds, true);
    strands.insert(strands.end(), arc.begin(), arc.end());
  }
  return strands;
}

/// From the tarsal plate up to Whitnall's ligament, which turns the pull of the muscle behind it upward.
std::vector<Strand> levator(const Placer& placer, int side) {
  const Eyeball& eye = placer.marks().eyes[side];
  const auto& margin = placer.marks().upper_lid[side];
  std::vector<Strand> strands;
  for (double s : {0.25, 0.5, 0.75}) {
    const Vector3d& p = margin[std::size_t(s * double(margin.size() - 1))];
    const Placer::Bed bed =
        placer.in_tissue(placer.shifted(p, 0, 3e-3 * placer.scale()), CutSide::above, placer.sheet().eyes[side].row);
    Strand strand;
    strand.origin = eye.centre + Vector3d(0.5 * (p.x() - eye.centre.x()), eye.radius + 0.010, 0.2 * eye.radius);
    strand.insertion = bed.place;
    strand.insertion_radius = bed.radius;
    strands.push_back(strand);
  }
  return strands;
}

/// From the nasal bones to the skin between the brows.
std::vector<Strand> procerus(const Placer& placer) {
  const Landmarks& marks = placer.marks();
  const Vector3d nasion = marks.at("nasion"), tip = marks.at("nose_tip"), glabella = marks.at("glabella");
  const double scale = 1e-3 * placer.scale();
  std::vector<Strand> strands;
  for (double sign : {-1, 1})
    strands.push_back(strand(placer, placer.shifted(nasion + 0.2 * (tip - nasion), 3 * sign * scale, 0), true,
                             placer.shifted(0.3 * nasion + 0.7 * glabella, 4 * sign * scale, 0)));
  return strands;
}

double section_of(const std::string& muscle) {
  for (const Section& s : sections)
    if (muscle == s.muscle) return 1e-6 * s.square_millimetres;
  return 0;
}

const std::vector<std::string> paired_muscles = {"frontalis_medial",
                                                 "frontalis_lateral",
                                                 "corrugator",
                                                 "depressor_supercilii",
                                                 "orbicularis_oculi_orbital",
                                                 "orbicularis_oculi_palpebral",
                                                 "levator_palpebrae",
                                                 "zygomaticus_major",
                                                 "zygomaticus_minor",
                                                 "levator_labii_alaeque",
                                                 "levator_labii",
                                                 "levator_anguli",
                                                 "depressor_anguli",
                                                 "depressor_labii",
                                                 "risorius",
                                                 "buccinator",
                                                 "mentalis",
                                                 "platysma"};

}  // namespace

const std::vector<std::string> muscle_names = [] {
  std::vector<std::string> names;
  for (const char* who : {"left_", "right_"})
    for (const std::string& name : paired_muscles) names.push_back(who + name);
  for (const char* name : {"procerus", "orbicularis_oris_marginal", "orbicularis_oris_peripheral"})
    names.push_back(name);
  return names;
}();

void place_muscles(const Landmarks& marks, const FaceSheet& sheet, const FaceTissue& tissue,
                   std::vector<Muscle>& muscles, std::vector<MuscleNote>& notes) {
  const Placer placer(marks, sheet, tissue);
  const Warp warp = warp_to(marks);
  const auto keep = [&](const std::string& name, const std::string& kind, std::vector<Strand> strands,
                        MuscleSource source) {
    const double section = section_of(kind) * placer.scale() * placer.scale();
    // arcs and rings carry their whole tension along the chain; strands side by side share it
    const bool in_line = kind.rfind("orbicularis", 0) == 0;
    const double arcs = kind.rfind("orbicularis_oculi", 0) == 0 ? 2 : 1;
    for (Strand& s : strands) s.force = stress * section / (in_line ? arcs : double(strands.size()));
    muscles.push_back({name, std::move(strands)});
    notes.push_back({source, section});
  };
  for (int side : {0, 1})
    for (const std::string& kind : paired_muscles) {
      std::vector<Strand> strands = published(placer, warp, kind, side);
      const MuscleSource source = strands.empty() ? MuscleSource::anatomy : MuscleSource::published;
      if (strands.empty()) strands = anatomical(placer, kind, side);
      if (kind == "orbicularis_oculi_orbital") strands = orbital_rings(placer, side);
      if (kind == "orbicularis_oculi_palpebral") strands = palpebral_arcs(placer, side);
      if (kind == "levator_palpebrae") strands = levator(placer, side);
      keep((side == 0 ? "left_" : "right_") + kind, kind, std::move(strands), source);
    }
  keep("procerus", "procerus", procerus(placer), MuscleSource::anatomy);
  for (const Ring& ring : rings)
    keep(ring.muscle, ring.muscle, mouth_ring(placer, warp, ring), MuscleSource::published);
}

}  // namespace face
