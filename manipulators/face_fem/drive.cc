#include "manipulators/face_fem/drive.h"

#include <algorithm>

namespace face {
namespace {

double level_of(const Levels& levels, int unit, int side) {
  const double l = levels[std::size_t(2 * unit)], r = levels[std::size_t(2 * unit + 1)];
  return side == 0 ? l : side == 1 ? r : 0.5 * (l + r);
}

// a sum of parts that never passes 1 and has no kink
void blend(double& sum, double more) { sum = 1 - (1 - sum) * (1 - more); }

LidPose lids(const Levels& levels, int side, const Eyes& eyes, const Habits& habits) {
  const double aperture = std::max(habits.aperture[std::size_t(side)], 0.1);
  const double up = eyes.elevation[std::size_t(side)] / aperture;
  double upper = -habits.upper_follows * up, lower = habits.lower_follows * up;
  double shut = 0, shut_below = 0;
  int u = 0;
  for (const ActionUnit& unit : action_units()) {
    const double level = level_of(levels, u++, side);
    if (unit.upper_lid < 0) upper += unit.upper_lid * level;
    const double above = std::max(unit.upper_lid, 0.0) * level, below = unit.lower_lid * level;
    blend(shut, above + below);
    blend(shut_below, below);
  }
  blend(shut, eyes.blink[std::size_t(side)]);
  blend(shut_below, 0.12 * eyes.blink[std::size_t(side)]);
  shut_below = std::min(shut_below, shut);
  // looking about opens and closes a little; what shuts takes its share of what is left open then
  upper = std::clamp(upper, -0.5, 0.6);
  lower = std::clamp(lower, -0.4, 0.3);
  const double open = 1 - upper - lower;
  return {upper + (shut - shut_below) * open, lower + shut_below * open};
}

}  // namespace

Driver::Driver(const std::vector<std::string>& muscles) : muscles_(muscles.size()) {
  const auto find = [&](const std::string& name) {
    const auto found = std::find(muscles.begin(), muscles.end(), name);
    return found == muscles.end() ? -1 : int(found - muscles.begin());
  };
  int u = -1;
  for (const ActionUnit& unit : action_units()) {
    ++u;
    for (const Pull& pull : unit.pulls) {
      const std::string name(pull.muscle);
      const int l = find("left_" + name), r = find("right_" + name), single = find(name);
      if (l >= 0) links_.push_back({u, left, l, pull.activation});
      if (r >= 0) links_.push_back({u, right, r, pull.activation});
      if (single >= 0) links_.push_back({u, 2, single, pull.activation});
      if (l < 0 && r < 0 && single < 0) missing_.push_back("AU" + std::to_string(unit.number) + ": no muscle " + name);
    }
  }
}

Drive Driver::drive(const Levels& levels, const Eyes& eyes, const Habits& habits) const {
  Drive drive;
  drive.activation.assign(muscles_, 0.0);
  for (const Link& link : links_)
    blend(drive.activation[std::size_t(link.muscle)], link.activation * level_of(levels, link.unit, link.side));
  double jaw = 0, thrust = 0;
  int u = 0;
  for (const ActionUnit& unit : action_units()) {
    const double level = level_of(levels, u++, 2);
    blend(jaw, unit.jaw * level);
    blend(thrust, unit.thrust * level);
    blend(drive.part, unit.part * level);
  }
  drive.jaw = jaw * habits.widest_jaw;
  drive.thrust = thrust * habits.thrust;
  drive.lids = {lids(levels, left, eyes, habits), lids(levels, right, eyes, habits)};
  return drive;
}

}  // namespace face
