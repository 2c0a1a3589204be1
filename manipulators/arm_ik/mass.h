#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

namespace arm_ik {

/// The segments of de Leva's table, each between two landmarks: head vertex to mid-gonion, trunk suprasternale to
/// mid-hip or its three parts cut at xiphion and navel, limbs from joint centre to joint centre, hand wrist to third
/// metacarpal head, foot heel to toe tip.
enum class Segment {
  head,
  trunk,
  upper_trunk,
  middle_trunk,
  lower_trunk,
  upper_arm,
  forearm,
  hand,
  thigh,
  shank,
  foot
};
constexpr std::array<std::string_view, 11> segment_words = {"head",        "trunk",     "upper_trunk", "middle_trunk",
                                                            "lower_trunk", "upper_arm", "forearm",     "hand",
                                                            "thigh",       "shank",     "foot"};
enum class Sex { male, female };

/// One row: fractions of body mass and, of the segment's length, the distance of the centre of mass from the first
/// landmark and the radii of gyration about the sagittal, transverse and long axis. de Leva (J Biomech 29:1223, 1996),
/// which adjusts Zatsiorsky and Seluyanov's.
struct SegmentRow {
  double mass, center, sagittal, transverse, longitudinal;
};
const SegmentRow& segment_row(Segment segment, Sex sex);

/// A rigid body: mass [kg], centre of mass [m], inertia about it [kg m^2], in the frame in which the ends were given.
struct MassProperties {
  double mass = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// A segment of a person of `body_mass` [kg] between two ends [m]. The sagittal axis (forwards) is the part of
/// `forward` at right angles to the length. Ends that coincide give a point mass.
MassProperties mass_properties(Segment segment, Sex sex, double body_mass, const Eigen::Vector3d& from,
                               const Eigen::Vector3d& to, const Eigen::Vector3d& forward);

}  // namespace arm_ik
