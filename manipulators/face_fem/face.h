#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "manipulators/face_fem/face_carrier.h"
#include "manipulators/face_fem/model.h"
#include "manipulators/face_fem/muscle.h"
#include "manipulators/mesh/surface.h"

namespace face {

/// A named point of the head. Names of points that come in pairs start with `left_` or `right_` (the person's own).
struct Landmark {
  std::string name;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< metres, the head's own coordinates
  double confidence = 1;  ///< 1 given by the caller or plainly seen; 0.5 guessed from proportions; between: weak relief
  std::string source;     ///< "given", "profile", "eyeball", "opening", "cleft", "proportion"
};

/// The names that a face always has, in this order: in the middle plane from top to bottom
/// `glabella nasion nose_tip subnasale upper_lip stomion lower_lip labiomental chin menton`, then for left and right
/// `mouth_corner nose_wing inner_canthus outer_canthus upper_lid lower_lid brow_inner brow_middle brow_outer cheekbone
/// jaw_angle jaw_joint ear`. `stomion` lies between the closed lips, `chin` is the foremost point of the chin
/// (pogonion), `menton` its lowest; `upper_lid` and `lower_lid` are the middles of the lid margins; `cheekbone` is the
/// most prominent point of the zygoma; `jaw_joint` is the condyle, under the skin.
extern const std::vector<std::string> landmark_names;

/// An eyeball: tissue of the lids slides over it.
struct Eyeball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< metres
  double radius = 0;                                 ///< metres, of the sclera
};

/// Where the jaw turns. Opening by a > 0 moves the jaw's bone by R(axis, a) about `centre`: the chin goes down and
/// back.
struct Hinge {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< middle between the condyles, metres
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();   ///< unit, to the person's left
};

/// Two nodes on either side of a slit, at the same place along it and at the same depth.
struct SlitPair {
  int upper = -1, lower = -1;  ///< indices into Model::nodes
  int column = 0;              ///< place along the slit, rising from the person's right to left
  int level = 0;               ///< 0 next to bone (or mouth), rising to the skin
  /// Unit, from the lower side to the upper: the gap is normal . (x_upper - x_lower), negative when they cross.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
};

/// A cut through the tissue. At its two ends the sides share their nodes (they are not among `pairs`).
/// At rest the lips touch (gap about 0); the lids stand open by the eye's aperture.
struct Slit {
  std::vector<SlitPair> pairs;  ///< by column, then by level; every level of the tissue
  int columns = 0, levels = 0;  ///< pairs.size() == columns * levels
  /// Nodes at the skin on the margins, from the right end to the left end, the shared end nodes included.
  std::vector<int> upper_margin, lower_margin;
};

/// The muscles that a face always has, in this order. Paired ones carry the prefix `left_` or `right_`:
/// frontalis_medial frontalis_lateral corrugator depressor_supercilii orbicularis_oculi_orbital
/// orbicularis_oculi_palpebral levator_palpebrae zygomaticus_major zygomaticus_minor levator_labii_alaeque
/// levator_labii levator_anguli depressor_anguli depressor_labii risorius buccinator mentalis platysma;
/// single ones: procerus orbicularis_oris_marginal orbicularis_oris_peripheral (rings).
extern const std::vector<std::string> muscle_names;

/// Where the geometry of a muscle comes from.
enum class MuscleSource {
  published,  ///< fibre ends of a published face mesh, warped by landmarks (design of Nazari et al. 2010, ArtiSynth)
  anatomy,    ///< placed on landmarks after anatomical description
};

/// What was done to place a muscle: row i belongs to Face::muscles[i].
struct MuscleNote {
  MuscleSource source = MuscleSource::anatomy;
  double cross_section = 0;  ///< m2 of all its strands; force = cross_section * 100 kPa * share reaching the skin
};

/// A face on a head: everything that control needs. Positions are in the coordinates of the head's surface (metres,
/// Y up, +Z forward), tissue at rest. Plain data.
///
/// To move it: Statics::make(face.model); Basis(statics, face.carrier.nodes()); one column for each of `muscles`
/// (load_of), bone columns by shifts of the supports whose `bone` is `jaw_bone`; Basis::frame; carrier.carry().
struct Face {
  Model model;  ///< layers "deep" "fat" "skin", one more "film" over the eyeballs; bones "skull" "jaw" "eye"
  std::vector<Muscle> muscles;           ///< #muscle_names, in that order; forces in newtons at activation 1
  std::vector<MuscleNote> muscle_notes;  ///< #muscles
  std::vector<Landmark> landmarks;       ///< #landmark_names, in that order
  Hinge jaw;
  int jaw_bone = 1;                ///< index into Model::bones
  std::array<Eyeball, 2> eyes;     ///< left, right
  Slit lips;                       ///< upper side hangs on the skull, lower side on the jaw
  std::array<Slit, 2> lids;        ///< left, right
  FaceCarrier carrier;             ///< from nodes to vertices of the head
  std::vector<std::string> notes;  ///< sentences worth telling: weak landmarks, ears clipped, holes bridged

  /// The landmark of that name; it must be one of landmark_names.
  const Landmark& landmark(const std::string& name) const;
  /// Index of the muscle of that name, -1 when there is none.
  int muscle(const std::string& name) const;
};

/// How a face is built.
struct FaceOptions {
  int columns = 32;                 ///< elements from ear to ear, even, 16 to 128; finer round mouth and eyes
  int rows = 32;                    ///< from under the chin to the hair line, 16 to 128
  int layers = 3;                   ///< from bone to skin, 3 to 12: one or more of each of deep, fat, skin
  Element element = Element::bbar;  ///< an 8-node one
  double poisson = 0.45;            ///< of deep, fat and skin
  double depth_scale = 1;           ///< factor on the published tissue depths
  double reach = 0.060;             ///< metres round the tissue over which the skin's motion fades
  std::map<std::string, Eigen::Vector3d> landmarks;  ///< what is known already, by name; replaces what is found
};

/// Builds the tissue under the face of `head`: a closed surface of a head or of a whole person upright and facing +Z,
/// metres; parts named *eye*, *sclera* or *iris* are eyeballs, other parts apart from the largest (teeth, lashes) are
/// left alone. Cost: about the same as factoring the model. Deterministic.
/// Errors: `not_finite`; `mesh` too few vertices, a skin with holes where the face is, not upright; `landmark` nose,
/// lips, chin or eyes not found (says which, and what was seen); `unknown` a landmark option that is no name; `limit`
/// options out of range; `inverted` tissue that folds (says where; a coarser grid or a given landmark helps).
Result<Face> build_face(const mesh::Surface& head, const FaceOptions& options = {});

}  // namespace face
