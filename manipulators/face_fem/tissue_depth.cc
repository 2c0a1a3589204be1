#include "manipulators/face_fem/tissue_depth.h"

#include <cmath>
#include <string>

namespace face {
namespace {

/// A site on the line between two landmarks (share of the way from the first), with its depth.
struct Norm {
  const char* name;
  const char* from;
  const char* to;
  double share;
  double millimetres;
};

/// Means of adults, millimetres. Pooled over studies by Stephan and Simpson, J Forensic Sci 53 (2008) 1257-1272:
/// glabella, nasion, mid-philtrum and pogonion were seen in print, the others of that table are from memory; its
/// revision found changes of at most 1 mm at 93 % of the sites (Stephan 2017, by its abstract). Entries marked
/// "cartilage" and "vault" are assumptions: the nose below its bones stands on cartilage that moves little.
constexpr Norm midline[] = {
    {"vault", "glabella", "nasion", -1.6, 4.8},
    {"supraglabella", "glabella", "nasion", -0.6, 5.0},
    {"glabella", "glabella", "nasion", 0, 5.5},
    {"nasion", "glabella", "nasion", 1, 6.5},
    {"rhinion", "nasion", "nose_tip", 0.45, 3.0},
    {"cartilage of the tip", "nasion", "nose_tip", 1, 9.0},
    {"subnasale", "subnasale", "upper_lip", 0, 13.0},
    {"mid-philtrum", "subnasale", "upper_lip", 0.5, 11.0},
    {"labrale superius", "subnasale", "upper_lip", 1, 11.5},
    {"labrale inferius", "lower_lip", "labiomental", 0, 13.0},
    {"chin-lip fold", "lower_lip", "labiomental", 1, 11.0},
    {"pogonion", "chin", "menton", 0, 11.5},
    {"menton", "chin", "menton", 1, 7.0},
};
constexpr Norm paired[] = {
    {"frontal eminence", "brow_middle", "upper_lid", -1.3, 4.8},
    {"mid-supraorbital", "brow_middle", "upper_lid", 0, 6.0},
    {"lateral supraorbital", "brow_outer", "outer_canthus", 0, 6.5},
    {"temple", "brow_outer", "ear", 0.35, 11.0},
    {"lateral orbit", "outer_canthus", "ear", 0.12, 8.0},
    {"mid-infraorbital", "lower_lid", "cheekbone", 0.6, 7.0},
    {"nose side", "inner_canthus", "nose_wing", 0.45, 4.5},
    {"cartilage of the wing", "nose_wing", "nose_wing", 0, 8.0},
    {"zygoma", "cheekbone", "jaw_joint", 0.05, 9.5},
    {"zygion", "cheekbone", "jaw_joint", 0.75, 6.5},
    {"supra canina", "nose_wing", "mouth_corner", 0.45, 10.5},
    {"infra canina", "mouth_corner", "labiomental", 0.5, 10.5},
    {"mouth corner", "mouth_corner", "mouth_corner", 0, 12.0},
    {"supra second molar", "mouth_corner", "jaw_joint", 0.40, 24.0},
    {"infra second molar", "mouth_corner", "jaw_angle", 0.45, 19.0},
    {"mid-ramus", "jaw_angle", "jaw_joint", 0.45, 17.5},
    {"gonion", "jaw_angle", "jaw_angle", 0, 10.5},
    {"mid-mandibular border", "jaw_angle", "menton", 0.5, 9.5},
};

}  // namespace

TissueDepth::TissueDepth(const FaceChart& chart, const Landmarks& marks, double scale) {
  const auto add = [&](const Norm& norm, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const ChartPoint a = chart.of(from), b = chart.of(to);
    const ChartPoint place = {a.angle + norm.share * (b.angle - a.angle), a.height + norm.share * (b.height - a.height),
                              0};
    sites_.push_back({norm.name, place, norm.millimetres * 1e-3 * scale});
  };
  for (const Norm& norm : midline) add(norm, marks.at(norm.from), marks.at(norm.to));
  const auto has_side = [](const std::string& name) { return name != "menton" && name != "labiomental"; };
  for (const char* who : {"left_", "right_"})
    for (const Norm& norm : paired)
      add(norm, marks.at(who + std::string(norm.from)),
          marks.at((has_side(norm.to) ? who : "") + std::string(norm.to)));
}

double TissueDepth::at(const ChartPoint& c) const {
  double sum = 0, weights = 0;
  for (const Site& site : sites_) {
    const double across = FaceChart::nominal * (c.angle - site.place.angle), up = c.height - site.place.height;
    // a millimetre rounds off the peak at the site itself
    const double weight = 1 / std::pow(across * across + up * up + 1e-6, 2);
    sum += weight * site.depth;
    weights += weight;
  }
  return sum / weights;
}

}  // namespace face
