#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace face {

/// What an action unit pulls at full intensity: a muscle of Face::muscles without its `left_` or `right_`, and the
/// activation it gets.
struct Pull {
  std::string_view muscle;
  double activation;
};

/// An action unit of the Facial Action Coding System (Ekman and Friesen 1978): what a coder can tell apart. The muscles
/// are those of its manual; activations, jaw and lids are our own and were tuned on pictures and on ICT-FaceKit.
struct ActionUnit {
  int number = 0;         ///< as in AU12
  std::string_view name;  ///< the manual's: "lip corner puller"
  bool sided = true;      ///< left and right can act alone (AU12L); the jaw cannot
  std::vector<Pull> pulls;
  double jaw = 0;        ///< opening of the jaw, parts of the widest
  double thrust = 0;     ///< protrusion of the jaw, parts of the farthest
  double upper_lid = 0;  ///< closure of the upper lid, parts of the opening at rest; negative widens
  double lower_lid = 0;  ///< likewise of the lower lid
  double part = 0;       ///< how far the lips give up their seal
};

/// All units, numbers rising.
std::span<const ActionUnit> action_units();

enum Side_of_face : int { left = 0, right = 1 };

/// One side of one unit: place 2 * unit + side in Levels.
constexpr int most_units = 40;
using Levels = std::array<double, std::size_t(2 * most_units)>;  ///< intensities 0..1 by place

/// The places that a word such as AU12, AU12L, AU4R names: both sides without a letter. Of a unit that has no sides
/// both places stand for it and move together; `AU26L` names none.
std::optional<std::vector<int>> places_of(std::string_view word);

/// "AU12L" for a place; "AU26" for both places of a unit without sides.
std::string_view word_of_place(int place);

}  // namespace face
