#include "manipulators/head_ik/figure.h"

#include <charconv>
#include <cmath>

namespace head {
namespace {

constexpr double right_angle = M_PI / 2;

// theta0 d a alpha of a freedom of a level
Eigen::Vector4d row(const Level& level, int freedom) {
  if (freedom != axial) return {-right_angle, 0, 0, right_angle};
  return {-right_angle, level.rise.y(), -level.rise.z(), right_angle};
}

std::string joint_name(const Level& level, int freedom, const FigureNames& names) {
  return names.prefix + level.name + "_" + std::string(name_of(static_cast<Freedom>(freedom)));
}

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value == 0 ? 0 : value);
  return text;
}

}  // namespace

std::string number(double value) {
  char text[32];
  // no minus sign on zero
  const auto end = std::to_chars(text, text + sizeof text, value == 0 ? 0 : value).ptr;
  return std::string(text, end);
}

std::string figure_script(const Neck& neck, const FigureNames& names, const Eigen::Vector3d& position) {
  const Eigen::Vector3d lowest = position + neck.base();
  const std::string half = number(std::sqrt(0.5));
  std::string script, parent = names.parent;
  for (int i = 0; i < neck.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Level& level = neck.levels()[i];
      const Eigen::Vector4d dh = row(level, k);
      const std::string name = joint_name(level, k, names);
      script += "create joint " + name + " parent " + parent;
      if (i == 0 && k == 0) {
        script += " position " + number(lowest.x()) + " " + number(lowest.y()) + " " + number(lowest.z());
        script += " orientation " + half + " 0 " + half + " 0";
      }
      script += " dh " + number(dh[0]) + " " + number(dh[1]) + " " + number(dh[2]) + " " + number(dh[3]);
      script += " lower " + number(level.lower[k]) + " upper " + number(level.upper[k]);
      if (level.rest[k] != 0) script += " rest " + number(level.rest[k]) + " angle " + number(level.rest[k]);
      script += "\n";
      parent = name;
    }
  script += "create node " + names.head + " parent " + parent + " orientation " + half + " 0 -" + half + " 0\n";
  return script;
}

std::string figure_table(const Neck& neck, const FigureNames& names) {
  std::string table = "| joint | theta0 deg | d m | a m | alpha deg | limits deg |\n|---|---|---|---|---|---|\n";
  for (const Level& level : neck.levels())
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector4d dh = row(level, k);
      table += "| `" + joint_name(level, k, names) + "` | " + rounded(dh[0] * 180 / M_PI) + " | " + rounded(dh[1]) +
               " | " + rounded(dh[2]) + " | " + rounded(dh[3] * 180 / M_PI) + " | " +
               rounded(level.lower[k] * 180 / M_PI) + " .. " + rounded(level.upper[k] * 180 / M_PI) + " |\n";
    }
  return table;
}

}  // namespace head
