#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "manipulators/head_ik/zyz.h"

namespace head {

/// The freedoms of a level, in the order in which they act from below, and the axis of the neck's frame each turns
/// about. The neck's frame is that of the head at rest: X to the person's left, Y up, Z forward. Positive is chin down,
/// right ear to right shoulder, face to the left.
enum Freedom { flexion, lateral, axial };
constexpr std::array<int, 3> axis_of{0, 2, 1};
std::string_view name_of(Freedom freedom);

/// One level of the neck: three turns about one centre [rad], each with its limits, lower <= rest <= upper.
struct Level {
  std::string name;
  Eigen::Vector3d lower, upper, rest;  ///< by Freedom
  Eigen::Vector3d rise;  ///< from this centre to the next one, the head's for the last [m], at zero angles
};

/// What a reported limit stands for.
enum class Limit { none, tilt, axial, both };
std::string_view name_of(Limit limit);

/// A neck is a stack of levels that turn together: a posture is three totals (flexion, lateral, axial) [rad], and every
/// level takes of each total the share that its own range has in the sum of all ranges. That is the published rule of
/// Mortensen, Vasavada and Merryweather (2018), six inputs with fixed shares, with both groups at equal fractions of
/// their ranges.
///
/// The set of postures is limited in swing and twist: the swing (flexion, lateral) lies in an ellipse through the sums
/// of the limits, the twist (axial) in an interval. The set is convex and inside the box of the joints' own limits, so
/// no joint leaves its range, and neither does any mean of two postures.
class Neck {
 public:
  static constexpr int most_levels = 16;
  /// A posture this little outside the set, relative to its size, counts as inside.
  static constexpr double inside_slack = 1e-12;

  /// Levels from bottom to top, 1 to `most_levels` of them; the centre of the lowest one in the neck's frame [m].
  explicit Neck(std::vector<Level> levels, const Eigen::Vector3d& base = Eigen::Vector3d::Zero());

  const std::vector<Level>& levels() const { return levels_; }
  const Eigen::Vector3d& base() const { return base_; }
  int size() const { return static_cast<int>(levels_.size()); }

  const Eigen::Vector3d& lowest() const { return lowest_; }    ///< the sums of the limits from rest, by Freedom
  const Eigen::Vector3d& highest() const { return highest_; }  ///< likewise

  /// The joint angles of a posture: flexion, lateral, axial of the lowest level, then of the next one.
  /// `angles`: 3 * size() numbers. Always inside the limits of each joint.
  void spread(const Eigen::Vector3d& total, double* angles) const;

  /// The rotation of the head and the position of its origin, both in the neck's frame.
  Eigen::Matrix3d rotation(const Eigen::Vector3d& total) const;
  Eigen::Vector3d origin_of_head(const Eigen::Vector3d& total) const;

  /// The published model's six inputs: the sums of the joint angles of the lower and the upper group. The upper group
  /// is the top two levels (C1-2 and C0-1), of two levels the top one.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> groups(const Eigen::Vector3d& total) const;

  /// How far out a posture is: 1 on the boundary of the swing ellipse (`tilt`) or of the axial interval.
  double tilt(const Eigen::Vector3d& total) const;
  double turn(const Eigen::Vector3d& total) const;

  /// The nearest posture of the set along a straight line to rest (tilt) and by clamping (axial).
  Eigen::Vector3d clamped(const Eigen::Vector3d& total) const;

  struct Solution {
    Eigen::Vector3d total{0, 0, 0};
    Limit limit = Limit::none;  ///< none: the orientation is reached
    double error = 0;           ///< angle between the head and the orientation asked for [rad]
    int iterations = 0;
  };

  /// The posture with orientation R (a rotation matrix in the neck's frame), or the nearest one of the set.
  /// What is near is the angle of rotation when roll_weight = 1; with a smaller weight a turn about the look axis
  /// counts less, so the gaze is kept at the expense of the roll. Newton's method from the swing-twist angles of R:
  /// quadratic, 3-5 steps, error <= 1e-13 rad when reached.
  Solution solve(const Eigen::Matrix3d& R, double roll_weight = 1) const;

 private:
  struct Frame;
  struct Trace;
  template <int order>
  void evaluate(const Eigen::Vector3d& total, Frame* frame) const;
  Trace trace(const Eigen::Vector3d& total, const Eigen::Matrix3d& M) const;
  Eigen::Vector3d guess(const Eigen::Matrix3d& R) const;
  enum class Found { inside, outside, nothing };
  Found reach(const Eigen::Matrix3d& R, Solution* solution) const;
  void approach(const Eigen::Matrix3d& M, Solution* solution) const;
  std::vector<Eigen::Vector3d> starts(const Eigen::Matrix3d& M, const Eigen::Vector3d& first) const;
  void survey();
  Eigen::Vector3d on_ellipse(double angle, double axial_total) const;
  double shortfall(const Eigen::Vector3d& total, const Eigen::Matrix3d& M) const;
  const double* shares(const Eigen::Vector3d& total, int freedom) const;

  std::vector<Level> levels_;
  Eigen::Vector3d base_;
  Eigen::Vector3d lowest_, highest_;
  Eigen::Matrix3d rest_rotation_;
  double swing_lag_ = 0;
  // postures all over the boundary of the set, to start from for a target far outside
  struct Lookout {
    Eigen::Vector3d total;
    Eigen::Matrix3d R;
  };
  static constexpr int most_lookouts = 80;
  std::vector<Lookout> lookouts_;
  // share of each level in a total, by side (0 below rest, 1 above) and freedom; and its rest angles
  std::array<std::array<std::array<double, most_levels>, 3>, 2> share_{};
  std::array<std::array<double, most_levels>, 3> rest_{};
};

/// The eight levels C7-T1 ... C0-1 with the published shares, limits and centres, `scale` 1 for a man of middle size.
Neck full_neck(double scale = 1);

/// Two levels, lower (C7-T1 to C2-3) and upper (C1-2, C0-1), each about the mean centre of the levels it stands for, so
/// that a small nod moves the head as the full neck does. The origin is the centre of C7-T1, as in the full neck.
Neck reduced_neck(double scale = 1);

}  // namespace head
