#pragma once

#include <array>
#include <vector>

#include "manipulators/face_fem/drive.h"
#include "manipulators/face_fem/face.h"

namespace face {

/// The lids of one eye as moving bones: the margin of a lid, stiffened by the tarsal plate, goes along the eyeball and
/// the tissue between it and the brow or cheek follows by its own elasticity. Each margin node goes round the axis
/// through the eye's centre towards its partner, at the distance from it that both have, so the lids close exactly and
/// do not cut into the eye.
class LidPath {
 public:
  /// `axis`: unit, to the person's left. Nodes that `held` already are left alone.
  LidPath(const Model& model, const Slit& slit, const Eyeball& eye, const Eigen::Vector3d& axis,
          const std::vector<bool>& held);

  /// Margin nodes of the upper (0) and the lower (1) lid.
  const std::vector<int>& nodes(int lid) const { return nodes_[std::size_t(lid)]; }
  /// Displacement of each node of a lid that has gone `part` of the way to the other one, metres.
  Eigen::Matrix3Xd shift(int lid, double part) const;
  /// Angle between the lids in the middle of the opening, radians.
  double aperture() const { return aperture_; }

  /// Places along the way at which a column of the basis is solved; between them the field is the polynomial through
  /// them and rest, whose error is below a hundredth of a millimetre.
  static constexpr int samples = 4;
  static constexpr std::array<double, samples> upper_samples = {-0.5, 0.35, 0.7, 1.0};
  static constexpr std::array<double, samples> lower_samples = {-0.4, 0.2, 0.4, 0.7};
  /// What each sample's column counts at `part`: Lagrange's polynomials through the samples and 0.
  static std::array<double, samples> weights(int lid, double part);

 private:
  struct Cylindrical {
    double along, radius, angle;
  };
  Cylindrical coordinates(const Eigen::Vector3d& p) const;
  Eigen::Vector3d place(const Cylindrical& c) const;

  Eigen::Vector3d centre_, axis_, up_, forward_;
  std::array<std::vector<int>, 2> nodes_;
  std::array<std::vector<Cylindrical>, 2> from_, to_;
  double aperture_ = 0.5;
};

}  // namespace face
