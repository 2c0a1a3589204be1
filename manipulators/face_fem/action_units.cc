#include "manipulators/face_fem/action_units.h"

#include <cassert>
#include <string>

namespace face {
namespace {

// which muscles: py-feat's reference table, after Ekman and Friesen; how much: ours
std::vector<ActionUnit> make_units() {
  return {
      {.number = 1, .name = "inner brow raiser", .pulls = {{"frontalis_medial", 1}}},
      {.number = 2, .name = "outer brow raiser", .pulls = {{"frontalis_lateral", 1}}},
      {.number = 4,
       .name = "brow lowerer",
       .pulls = {{"corrugator", 1}, {"procerus", 0.7}, {"depressor_supercilii", 0.8}}},
      {.number = 5, .name = "upper lid raiser", .pulls = {}, .upper_lid = -0.45},
      {.number = 6,
       .name = "cheek raiser",
       .pulls = {{"orbicularis_oculi_orbital", 1}, {"malaris", 1}},
       .upper_lid = 0.05,
       .lower_lid = 0.12},
      {.number = 7,
       .name = "lid tightener",
       .pulls = {{"orbicularis_oculi_palpebral", 1}},
       .upper_lid = 0.12,
       .lower_lid = 0.22},
      {.number = 9,
       .name = "nose wrinkler",
       .pulls = {{"levator_labii_alaeque", 1}, {"procerus", 0.6}, {"depressor_supercilii", 0.4}},
       .part = 0.2},
      {.number = 10, .name = "upper lip raiser", .pulls = {{"levator_labii", 1}}, .part = 0.6},
      {.number = 11, .name = "nasolabial deepener", .pulls = {{"zygomaticus_minor", 1}}},
      {.number = 12, .name = "lip corner puller", .pulls = {{"zygomaticus_major", 1}}},
      {.number = 13, .name = "sharp lip puller", .pulls = {{"levator_anguli", 1}}},
      {.number = 14, .name = "dimpler", .pulls = {{"buccinator", 1}}},
      {.number = 15, .name = "lip corner depressor", .pulls = {{"depressor_anguli", 1}}},
      {.number = 16, .name = "lower lip depressor", .pulls = {{"depressor_labii", 1}}, .part = 1},
      {.number = 17, .name = "chin raiser", .pulls = {{"mentalis", 1}}},
      {.number = 18,
       .name = "lip pucker",
       .pulls = {{"incisivus", 1}, {"orbicularis_oris_peripheral", 0.4}, {"orbicularis_oris_marginal", 0.3}},
       .part = 0.3},
      {.number = 20, .name = "lip stretcher", .pulls = {{"risorius", 1}, {"platysma", 0.4}}},
      {.number = 21, .name = "neck tightener", .pulls = {{"platysma", 1}}},
      {.number = 22,
       .name = "lip funneler",
       .pulls = {{"orbicularis_oris_peripheral", 0.8}, {"incisivus", 0.4}},
       .part = 1},
      {.number = 23, .name = "lip tightener", .pulls = {{"orbicularis_oris_marginal", 0.6}}},
      {.number = 24, .name = "lip pressor", .pulls = {{"orbicularis_oris_marginal", 1}}},
      {.number = 25, .name = "lips part", .pulls = {{"depressor_labii", 0.4}, {"levator_labii", 0.15}}, .part = 1},
      {.number = 26, .name = "jaw drop", .sided = false, .pulls = {}, .jaw = 0.5, .part = 1},
      {.number = 27, .name = "mouth stretch", .sided = false, .pulls = {}, .jaw = 1, .part = 1},
      {.number = 29, .name = "jaw thrust", .sided = false, .pulls = {}, .thrust = 1},
      {.number = 43, .name = "eyes closed", .pulls = {}, .upper_lid = 0.88, .lower_lid = 0.12},
      {.number = 45,
       .name = "blink",
       .pulls = {{"orbicularis_oculi_palpebral", 0.3}},
       .upper_lid = 0.88,
       .lower_lid = 0.12},
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
