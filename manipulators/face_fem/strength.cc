#include "manipulators/face_fem/strength.h"

#include <string>
#include <string_view>

namespace face {
namespace {

struct Strength {
  std::string_view muscle;
  double force;            // factor
  double radius;           // of the ends in tissue, metres
  double to_modiolus = 0;  // share of the way that the insertion is drawn there
};

constexpr Strength table[] = {
    {"frontalis_medial", 0.9, 0.012},
    {"frontalis_lateral", 0.9, 0.012},
    {"corrugator", 0.9, 0.008},
    {"depressor_supercilii", 1.0, 0.007},
    {"procerus", 1.0, 0.007},
    {"orbicularis_oculi_orbital", 0.8, 0.010},
    {"orbicularis_oculi_palpebral", 0.5, 0.005},
    {"zygomaticus_major", 2.2, 0.010, 0.75},
    {"zygomaticus_minor", 1.5, 0.008},
    {"levator_labii_alaeque", 3.0, 0.007},
    {"levator_labii", 0.9, 0.008},
    {"levator_anguli", 1.0, 0.008, 0.5},
    {"depressor_anguli", 0.8, 0.008, 0.75},
    {"depressor_labii", 0.4, 0.006},
    {"risorius", 1.2, 0.010, 0.6},
    {"buccinator", 0.6, 0.008, 0.5},
    {"mentalis", 0.8, 0.007},
    {"platysma", 0.5, 0.009},
    {"orbicularis_oris_marginal", 0.4, 0.005},
    {"orbicularis_oris_peripheral", 0.5, 0.007},
};

std::string_view kind_of(std::string_view name) {
  for (std::string_view side : {"left_", "right_"})
    if (name.starts_with(side)) return name.substr(side.size());
  return name;
}

// the height of the lower face of the heads that the table was fitted on, nasion to menton, metres
constexpr double fitted_height = 0.105;
// from the corner of the mouth, outward and inward into the head, metres
constexpr double modiolus_out = 0.004, modiolus_in = 0.004;

}  // namespace

Face strengthened(Face face) {
  const auto place = [&](const std::string& name) -> const Eigen::Vector3d* {
    for (const Landmark& mark : face.landmarks)
      if (mark.name == name) return &mark.place;
    return nullptr;
  };
  const Eigen::Vector3d *nasion = place("nasion"), *menton = place("menton");
  const double scale = nasion && menton ? (nasion->y() - menton->y()) / fitted_height : 1;
  for (Muscle& muscle : face.muscles)
    for (const Strength& row : table) {
      if (row.muscle != kind_of(muscle.name)) continue;
      const std::string side = muscle.name.substr(0, muscle.name.find('_') + 1);
      const Eigen::Vector3d* corner = row.to_modiolus > 0 ? place(side + "mouth_corner") : nullptr;
      for (Strand& strand : muscle.strands) {
        strand.force *= row.force;
        if (strand.origin_radius > 0) strand.origin_radius = row.radius * scale;
        if (strand.insertion_radius > 0) strand.insertion_radius = row.radius * scale;
        if (corner == nullptr) continue;
        const double out = corner->x() > 0 ? modiolus_out : -modiolus_out;
        const Eigen::Vector3d modiolus = *corner + scale * Eigen::Vector3d(out, 0, -modiolus_in);
        strand.insertion += row.to_modiolus * (modiolus - strand.insertion);
      }
    }
  return face;
}

}  // namespace face
