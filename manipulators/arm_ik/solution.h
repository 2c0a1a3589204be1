#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace arm_ik {

/// How a solve ended.
enum class Status {
  reached,      ///< both errors within tolerance
  moving,       ///< on its way: joint rates do not allow more in one tick
  limited,      ///< nearest posture found; joint limits keep it from the goal
  unreachable,  ///< nearest posture found; the chain is too short (or too long) for the goal
  budget,       ///< work ran out; best posture so far
};

/// The word of a status, as it stands in files and fields.
std::string_view name_of(Status status);

enum class Method {
  automatic,  ///< the cheapest that meets task and tolerance
  limb,       ///< closed form: girdle given, elbow, forearm and swivel
  rhythm,     ///< five inputs, girdle driven by the scapulohumeral rhythm
  full,       ///< all freedoms, projected Levenberg-Marquardt from where the arm is
  reach,      ///< all freedoms, many starts: cold start
  polish,     ///< reach, then Newton down to rounding
  clamped,    ///< damped least squares with a rate bound: slow, steady reference
};

std::string_view name_of(Method method);
/// The method of a word; false when there is none.
bool method_named(std::string_view word, Method& out);
/// All method words, blank separated.
std::string method_words();

/// What a solver says about its answer. The posture itself is the caller's array.
struct Solution {
  Status status = Status::budget;
  Method method = Method::automatic;
  double position_error = 0;  ///< [m]
  double rotation_error = 0;  ///< [rad]; 0 when no orientation was asked for
  int iterations = 0;         ///< linear solves, all starts together
  int starts = 0;             ///< descents begun
};

}  // namespace arm_ik
