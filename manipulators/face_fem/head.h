#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "manipulators/face_fem/error.h"
#include "manipulators/face_fem/face.h"
#include "manipulators/mesh/surface.h"
#include "manipulators/mesh/tree.h"

namespace face {

/// The skin of a head, ready to be scanned. Metres, Y up, +Z forward.
class Head {
 public:
  /// Takes the skin (the largest connected part that is no eyeball) and the eyeballs out of `surface`; of a whole
  /// person only what lies within 0.30 m of the top is kept. Errors: `not_finite`, `mesh`.
  static Result<Head> take(const mesh::Surface& surface);

  const mesh::Surface& skin() const { return *skin_; }
  /// For each vertex of skin() its number in the surface it was taken from.
  const std::vector<int>& vertex() const { return vertex_; }
  /// Eyeballs found as parts: 0 left, 1 right.
  const std::array<std::optional<Eyeball>, 2>& eyeballs() const { return eyeballs_; }
  double top() const { return top_; }
  double middle() const { return middle_; }  ///< x of the middle plane
  bool closed() const { return closed_; }    ///< there is skin behind too: a head, not a mask or a scan of the face

  /// The outermost point of the skin on the ray from `origin` along the unit `direction`, as its distance from origin;
  /// nothing when the ray meets no skin, or only its inside through a hole.
  std::optional<double> outermost(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// z of the skin seen from the front at (x, y).
  std::optional<double> front(double x, double y) const;

 private:
  std::unique_ptr<mesh::Surface> skin_;
  std::unique_ptr<mesh::Tree> tree_;
  std::vector<int> vertex_;
  std::array<std::optional<Eyeball>, 2> eyeballs_;
  double top_ = 0, middle_ = 0, back_ = 0;
  bool closed_ = true;
};

}  // namespace face
