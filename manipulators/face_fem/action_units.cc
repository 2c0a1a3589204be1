#include "manipulators/face_fem/action_units.h"

#include <cassert>
#include <string>

namespace face {
namespace {

// which muscles: py-feat's reference table, after Ekman and Friesen; how much: ours
std::vector<ActionUnit> make_units() {
  return {
      {1, "inner brow raiser", true, {{"frontalis_medial", 1}}},
      {2, "outer brow raiser", true, {{"frontalis_lateral", 1}}},
      {4, "brow lowerer", true, {{"corrugator", 1}, {"procerus", 0.7}, {"depressor_supercilii", 0.8}}},
      {.number = 5, .name = "upper lid raiser", .sided = true, .pulls = {}, .upper_lid = -0.35},
      {.number = 6,
       .name = "cheek raiser",
       .sided = true,
       .pulls = {{"orbicularis_oculi_orbital", 1}},
       .upper_lid = 0.05,
       .lower_lid = 0.15},
      {.number = 7,
       .name = "lid tightener",
       .sided = true,
       .pulls = {{"orbicularis_oculi_palpebral", 1}},
       .upper_lid = 0.12,
       .lower_lid = 0.25},
      {9, "nose wrinkler", true, {{"levator_labii_alaeque", 1}, {"procerus", 0.5}, {"depressor_supercilii", 0.4}}},
      {10, "upper lip raiser", true, {{"levator_labii", 1}}},
      {11, "nasolabial deepener", true, {{"zygomaticus_minor", 1}}},
      {12, "lip corner puller", true, {{"zygomaticus_major", 1}}},
      {13, "sharp lip puller", true, {{"levator_anguli", 1}}},
      {14, "dimpler", true, {{"buccinator", 1}}},
      {15, "lip corner depressor", true, {{"depressor_anguli", 1}}},
      {16, "lower lip depressor", true, {{"depressor_labii", 1}}},
      {17, "chin raiser", true, {{"mentalis", 1}}},
      {18, "lip pucker", true, {{"orbicularis_oris_peripheral", 1}, {"orbicularis_oris_marginal", 0.5}}},
      {20, "lip stretcher", true, {{"risorius", 1}, {"platysma", 0.4}}},
      {21, "neck tightener", true, {{"platysma", 1}}},
      {22, "lip funneler", true, {{"orbicularis_oris_peripheral", 1}}},
      {23, "lip tightener", true, {{"orbicularis_oris_marginal", 0.6}}},
      {24, "lip pressor", true, {{"orbicularis_oris_marginal", 1}}},
      {.number = 25, .name = "lips part", .sided = true, .pulls = {{"depressor_labii", 0.45}, {"levator_labii", 0.15}}},
      {.number = 26, .name = "jaw drop", .sided = false, .pulls = {}, .jaw = 0.5},
      {.number = 27, .name = "mouth stretch", .sided = false, .pulls = {}, .jaw = 1},
      {.number = 28, .name = "lip suck", .sided = true, .pulls = {{"orbicularis_oris_marginal", 1}}},
      {.number = 29, .name = "jaw thrust", .sided = false, .pulls = {}, .thrust = 1},
      {.number = 43, .name = "eyes closed", .sided = true, .pulls = {}, .upper_lid = 0.9, .lower_lid = 0.1},
      {.number = 45,
       .name = "blink",
       .sided = true,
       .pulls = {{"orbicularis_oculi_palpebral", 0.3}},
       .upper_lid = 0.9,
       .lower_lid = 0.1},
  };
}

struct Words {
  std::vector<std::string> plain;     // by unit
  std::vector<std::string> by_place;  // by place
};

const Words& words() {
  static const Words made = [] {
    Words w;
    for (const ActionUnit& unit : action_units()) {
      const std::string plain = "AU" + std::to_string(unit.number);
      w.plain.push_back(plain);
      for (const char* side : {"L", "R"}) w.by_place.push_back(unit.sided ? plain + side : plain);
    }
    return w;
  }();
  return made;
}

}  // namespace

std::span<const ActionUnit> action_units() {
  static const std::vector<ActionUnit> units = make_units();
  assert(units.size() <= std::size_t(most_units));
  return units;
}

std::optional<std::vector<int>> places_of(std::string_view word) {
  const Words& known = words();
  for (std::size_t u = 0; u < known.plain.size(); ++u)
    if (known.plain[u] == word) return std::vector<int>{int(2 * u), int(2 * u + 1)};
  for (std::size_t p = 0; p < known.by_place.size(); ++p)
    if (known.by_place[p] == word) return std::vector<int>{int(p)};
  return std::nullopt;
}

std::string_view word_of_place(int place) { return words().by_place[std::size_t(place)]; }

}  // namespace face
