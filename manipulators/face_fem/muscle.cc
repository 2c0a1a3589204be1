#include "manipulators/face_fem/muscle.h"

#include <Eigen/Dense>
#include <cmath>

namespace face {
namespace {

/// the sentence's subject: "muscle zygomaticus, strand 2"
Error about(const Muscle& muscle, std::size_t strand, Fault fault, const std::string& sentence) {
  return {fault, "muscle " + muscle.name + (muscle.strands.size() > 1 ? ", strand " + std::to_string(strand + 1) : "") +
                     ": " + sentence};
}

Status check_strand(const Muscle& muscle, std::size_t k) {
  const Strand& s = muscle.strands[k];
  if (!s.origin.allFinite() || !s.insertion.allFinite() || !std::isfinite(s.force))
    return about(muscle, k, Fault::not_finite, "its places and its force must be finite");
  if (!(s.origin_radius >= 0) || !(s.insertion_radius >= 0) || !std::isfinite(s.origin_radius + s.insertion_radius))
    return about(muscle, k, Fault::muscle, "its radii must be 0 (bone) or more");
  if (s.origin_radius == 0 && s.insertion_radius == 0)
    return about(muscle, k, Fault::muscle, "both radii are 0, so it would pull bone at bone; give one end a radius");
  if (!((s.insertion - s.origin).norm() > 0))
    return about(muscle, k, Fault::muscle, "origin and insertion are the same point, so it has no direction");
  return success();
}

}  // namespace

Result<MuscleLoad> load_of(const Model& model, const ElementBoxes& boxes, const Muscle& muscle,
                           const SpreadOptions& options) {
  if (muscle.strands.empty()) return Error{Fault::muscle, "muscle " + muscle.name + ": has no strands"};
  MuscleLoad result;
  result.load = Field::Zero(3, int(model.nodes.size()));
  result.net.setZero();
  for (std::size_t k = 0; k < muscle.strands.size(); ++k) {
    if (auto status = check_strand(muscle, k); !status) return status.error();
    const Strand& s = muscle.strands[k];
    const Eigen::Vector3d pull = s.force * (s.insertion - s.origin).normalized();
    for (const bool at_origin : {true, false}) {
      const double radius = at_origin ? s.origin_radius : s.insertion_radius;
      // no tissue is pulled at an end in bone
      if (radius == 0) continue;
      const Eigen::Vector3d& centre = at_origin ? s.origin : s.insertion;
      auto end = spread(model, boxes, centre, radius, options);
      if (!end)
        return about(muscle, k, end.error().fault, (at_origin ? "origin: " : "insertion: ") + end.error().sentence);
      const Eigen::Vector3d force = at_origin ? pull : Eigen::Vector3d(-pull);
      for (const auto& [node, share] : end->share) result.load.col(node) += share * force;
      result.net += end->total * force;
      result.inside = std::min(result.inside, end->inside);
    }
  }
  return result;
}

std::vector<Strand> ring(const std::vector<Eigen::Vector3d>& points, bool closed, double radius, double force) {
  std::vector<Strand> strands;
  const std::size_t count = points.size();
  for (std::size_t k = 0; k + 1 < count + closed; ++k)
    strands.push_back({points[k], points[(k + 1) % count], radius, radius, force});
  return strands;
}

}  // namespace face
