#pragma once

#include <array>
#include <string>
#include <vector>

#include "manipulators/face_fem/action_units.h"

namespace face {

/// Where the eyes look and how far a blink has come, as the program that moves them says; by side.
struct Eyes {
  std::array<double, 2> elevation{};  ///< radians, upwards
  std::array<double, 2> blink{};      ///< 0 open, 1 closed
};

/// The lids of one eye. Both are parts of the opening at rest that a lid goes towards the other one; negative away from
/// it. They touch where their sum is 1, and it never exceeds 1.
struct LidPose {
  double upper = 0, lower = 0;
  bool operator==(const LidPose&) const = default;
};

/// What a face is told to do at one moment: muscles, bones, lids.
struct Drive {
  std::vector<double> activation;  ///< 0..1, by muscle
  double jaw = 0;                  ///< radians of opening
  double thrust = 0;               ///< metres forward
  std::array<LidPose, 2> lids;     ///< left, right
  double part = 0;                 ///< 0 lips sealed, 1 free
  bool operator==(const Drive&) const = default;
};

/// How a face answers to levels. The defaults are a grown person's.
struct Habits {
  double widest_jaw = 0.28;     ///< radians at AU27=1: 16 degrees
  double thrust = 0.005;        ///< metres at AU29=1
  double upper_follows = 0.75;  ///< of the eye's elevation that the upper lid goes with
  double lower_follows = 0.35;  ///< likewise of the lower lid
  /// Angle between the lids of each eye at rest as seen from its centre, radians.
  std::array<double, 2> aperture = {0.7, 0.7};
};

/// Turns levels of action units into a drive of the muscles of that list of names (Face::muscles). A muscle that
/// several units pull gets 1 - product of (1 - pull); one without sides gets the mean of both.
class Driver {
 public:
  /// Errors of the table, a pull that names no muscle of the list, end up in `missing`.
  explicit Driver(const std::vector<std::string>& muscles);

  Drive drive(const Levels& levels, const Eyes& eyes, const Habits& habits) const;
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  struct Link {
    int unit;
    int side;  // 0, 1 or 2 for the mean of both
    int muscle;
    double activation;
  };
  std::size_t muscles_;
  std::vector<Link> links_;
  std::vector<std::string> missing_;
};

}  // namespace face
