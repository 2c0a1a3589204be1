#include "manipulators/face_fem/strength.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace face {
namespace {

struct Strength {
  std::string_view muscle;
  double force;                        // factor
  double radius;                       // of the ends in tissue, metres
  double to_modiolus = 0;              // share of the way that the insertion is drawn there
  double outward = 0;                  // both ends away from the middle plane, metres
  Eigen::Vector3d origin = {0, 0, 0};  // shift of the end in bone: outward, up, forward, metres
};

const Strength table[] = {
    {"frontalis_medial", 2.1, 0.014, 0, -0.005},
    {"frontalis_lateral", 1.25, 0.014},
    {"corrugator", 1.5, 0.011, 0, 0.006},
    {"depressor_supercilii", 1.4, 0.007},
    {"procerus", 1.4, 0.007},
    {"orbicularis_oculi_orbital", 1.0, 0.010},
    {"orbicularis_oculi_palpebral", 0.5, 0.005},
    {"zygomaticus_major", 1.72, 0.012, 0.85, 0, {0.012, 0, 0}},
    {"zygomaticus_minor", 2.2, 0.009},
    {"levator_labii_alaeque", 3.1, 0.008},
    {"levator_labii", 1.3, 0.009, 0, 0.003},
    {"levator_anguli", 1.6, 0.008, 0.5},
    {"depressor_anguli", 0.9, 0.009, 0.75, 0, {0.008, 0, -0.008}},
    {"depressor_labii", 0.85, 0.007},
    {"risorius", 1.7, 0.011, 0.7},
    {"buccinator", 0.75, 0.010, 0.5},
    {"mentalis", 1.2, 0.008},
    {"platysma", 0.8, 0.010},
    {"orbicularis_oris_marginal", 0.6, 0.005},
    {"orbicularis_oris_peripheral", 0.7, 0.007},
    {"incisivus", 1.15, 0.008},
    {"malaris", 1.45, 0.012},
};

std::string_view kind_of(std::string_view name) {
  for (std::string_view side : {"left_", "right_"})
    if (name.starts_with(side)) return name.substr(side.size());
  return name;
}

// the height of the lower face of the heads that the table was fitted on, nasion to menton, metres
constexpr double fitted_height = 0.105;
// a muscle that ends at the modiolus is woven into the cheek before: the parts of its force that pull there and on the
// way to where its fibre ended
constexpr double at_modiolus = 0.5, before = 0.5;
// incisivus, newtons of each of its two strands
constexpr double incisivus_force = 1.2;
// malaris, likewise
constexpr double malaris_force = 1.5;
// from the corner of the mouth, outward and inward into the head, metres
constexpr double modiolus_out = 0.004, modiolus_in = 0.004;

const Eigen::Vector3d* place(const Face& face, const std::string& name) {
  for (const Landmark& mark : face.landmarks)
    if (mark.name == name) return &mark.place;
  return nullptr;
}

Eigen::Vector3d modiolus_at(const Eigen::Vector3d& corner, double scale) {
  return corner + scale * Eigen::Vector3d(corner.x() > 0 ? modiolus_out : -modiolus_out, 0, -modiolus_in);
}

// Incisivus labii superioris and inferioris: from the bone over the lateral incisors to the modiolus. They draw the
// corners together and forward, which is what purses the lips; a ring alone only presses them on the teeth. The end in
// bone is put before the teeth, for what the flesh does that is bunched between them and pushed outward.
void add_incisivus(Face& face, double scale) {
  const Eigen::Vector3d *upper = place(face, "upper_lip"), *lower = place(face, "lower_lip");
  for (const std::string side : {"left_", "right_"}) {
    const Eigen::Vector3d* corner = place(face, side + "mouth_corner");
    if (corner == nullptr || upper == nullptr || lower == nullptr) continue;
    Muscle muscle{side + "incisivus", {}};
    for (const double up : {1.0, -1.0}) {
      Strand strand;
      strand.origin =
          (up > 0 ? *upper : *lower) + scale * Eigen::Vector3d(corner->x() > 0 ? 0.006 : -0.006, 0.006 * up, 0.004);
      strand.insertion = modiolus_at(*corner, scale);
      strand.insertion_radius = 0.008;
      strand.force = incisivus_force;
      muscle.strands.push_back(strand);
    }
    face.muscles.push_back(std::move(muscle));
    face.muscle_notes.push_back({MuscleSource::anatomy, incisivus_force * 2 / 100e3});
  }
}

// Musculus malaris, the part of orbicularis oculi that hangs the cheek on the rim of the orbit: it lifts the cheek,
// which the ring alone does not. From the rim beside the outer canthus to the skin over the cheekbone.
void add_malaris(Face& face, double scale) {
  for (const std::string side : {"left_", "right_"}) {
    const Eigen::Vector3d *canthus = place(face, side + "outer_canthus"), *cheek = place(face, side + "cheekbone");
    if (canthus == nullptr || cheek == nullptr) continue;
    const double out = canthus->x() > 0 ? scale : -scale;
    Muscle muscle{side + "malaris", {}};
    for (const double across : {-0.010, 0.004}) {
      Strand strand;
      strand.origin = *canthus + Eigen::Vector3d(0.006 * out, 0.010 * scale, -0.002 * scale);
      strand.insertion = *cheek + Eigen::Vector3d(across * out, -0.004 * scale, -0.005 * scale);
      strand.insertion_radius = 0.012;
      strand.force = malaris_force;
      muscle.strands.push_back(strand);
    }
    face.muscles.push_back(std::move(muscle));
    face.muscle_notes.push_back({MuscleSource::anatomy, malaris_force * 2 / 100e3});
  }
}

}  // namespace

Face strengthened(Face face) {
  const Eigen::Vector3d *nasion = place(face, "nasion"), *menton = place(face, "menton");
  const double scale = nasion && menton ? (nasion->y() - menton->y()) / fitted_height : 1;
  add_incisivus(face, scale);
  add_malaris(face, scale);
  for (Muscle& muscle : face.muscles)
    for (const Strength& row : table) {
      if (row.muscle != kind_of(muscle.name)) continue;
      const std::string side = muscle.name.substr(0, muscle.name.find('_') + 1);
      const double outward = side == "right_" ? -1 : 1;
      const Eigen::Vector3d* corner = row.to_modiolus > 0 ? place(face, side + "mouth_corner") : nullptr;
      std::vector<Strand> woven;
      for (Strand& strand : muscle.strands) {
        strand.force *= row.force;
        if (row.outward != 0)
          for (Eigen::Vector3d* end : {&strand.origin, &strand.insertion})
            end->x() = outward * std::max(outward * end->x() + scale * row.outward, 0.0);
        strand.origin += scale * Eigen::Vector3d(outward * row.origin.x(), row.origin.y(), row.origin.z());
        if (strand.origin_radius > 0) strand.origin_radius = row.radius * scale;
        if (strand.insertion_radius > 0) strand.insertion_radius = row.radius * scale;
        if (corner == nullptr) continue;
        const Eigen::Vector3d modiolus = modiolus_at(*corner, scale);
        Strand cheek = strand;
        cheek.force *= before;
        cheek.insertion += 0.3 * row.to_modiolus * (modiolus - strand.insertion);
        woven.push_back(cheek);
        strand.force *= at_modiolus;
        strand.insertion += row.to_modiolus * (modiolus - strand.insertion);
      }
      muscle.strands.insert(muscle.strands.end(), woven.begin(), woven.end());
    }
  return face;
}

}  // namespace face
