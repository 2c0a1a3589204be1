#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "manipulators/mesh/dress.h"
#include "manipulators/mesh/figure/landmarks.h"
#include "manipulators/mesh/figure/skeleton.h"

namespace figure {

/// A garment as the language describes it: bones by name, a colour, a layer.
struct Clothing {
  std::string name;
  std::vector<std::string> bones;  ///< names of segments; empty: all
  Eigen::MatrixX4d planes = Eigen::MatrixX4d(0, 4);
  Eigen::MatrixX4d lines = Eigen::MatrixX4d(0, 4);
  double thickness = 0;  ///< metres
  Eigen::Vector4d flare = Eigen::Vector4d::Zero();
  int smoothing = 0;
  int layer = 0;
  Eigen::Vector3d color = Eigen::Vector3d::Zero();  ///< red green blue, sRGB, 0 to 1
  double gloss = 0.1;
};

/// A sailor's walking-out dress, from the skin outwards: hair, brows and lips; trousers, blouse with square collar and
/// striped shirt in its opening, neckerchief, cuffs, shoes. Lengths go with the stature. In order of layer, then name.
std::vector<Clothing> uniform(const Landmarks& landmarks);

/// The same for mesh::dress(): bone names become indices into bones(skeleton).
std::vector<mesh::Garment> garments(const std::vector<Clothing>& clothing, const std::vector<mesh::Bone>& bones);

/// The cap in the head's frame, turned up all round, as one closed part `cap`.
mesh::Surface cap(const Landmarks& landmarks);

/// The left shoe in the frame of the node left_foot, as one closed part `shoe`: the hull of the foot's sections from
/// heel to toe, with a flat sole.
mesh::Surface shoe(const mesh::Surface& body, const Landmarks& landmarks);

/// The mirror image in x = 0, its faces still counter-clockwise from outside.
mesh::Surface mirror_image(mesh::Surface surface);

/// How high the soles of the shoes lift the bare foot, metres.
double sole(const Landmarks& landmarks);

}  // namespace figure
