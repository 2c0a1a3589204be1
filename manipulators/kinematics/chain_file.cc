#include "manipulators/kinematics/chain_file.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "manipulators/kinematics/table.h"

namespace kinematics {

using objdb::ErrorKind;
using objdb::Result;

namespace {

constexpr std::array<const char*, 8> dh_header = {"joint",     "theta0_deg", "d_m",       "a_m",
                                                  "alpha_deg", "lower_deg",  "upper_deg", "rest_deg"};
// a transform written with a few decimals is not quite a rotation; more than this is a mistake
constexpr double rotation_tolerance = 1e-4;
// metres and degrees beyond this are a mistake, and their squares no numbers
constexpr double largest = 1e9;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Result<Pose> read_pose(const Table& table, const Row& row) {
  const std::string name = row.cells[0].text;
  if (row.cells.size() != 13) {
    return refusal(table.file, row.line, 1, ErrorKind::syntax,
                   name + " has " + std::to_string(row.cells.size() - 1) + " numbers, expected 12 (3x4, row by row)");
  }
  Pose X;
  for (int i = 0; i < 12; ++i) {
    const Result<double> value = number(table, row, row.cells[i + 1], name + " number " + std::to_string(i + 1));
    if (!value) return value.error();
    if (std::abs(*value) > largest) {
      return refusal(
          table.file, row.line, row.cells[i + 1].column, ErrorKind::range,
          name + " number " + std::to_string(i + 1) + " is " + row.cells[i + 1].text + ", expected within 1e9");
    }
    (i % 4 == 3 ? X.p[i / 4] : X.R(i / 4, i % 4)) = *value;
  }
  if (rotation_defect(X.R) > rotation_tolerance) {
    return refusal(table.file, row.line, 1, ErrorKind::range,
                   name + " is not a rigid transform: its 3x3 part is no rotation");
  }
  // back onto the rotations, so that long chains stay rigid to rounding
  X.R = rotation_from_quaternion(quaternion(X.R));
  return X;
}

std::optional<objdb::Error> check_header(const Table& table) {
  for (std::size_t i = 0; i < dh_header.size(); ++i) {
    const bool there = i < table.header.cells.size();
    if (there && table.header.cells[i].text == dh_header[i]) continue;
    const std::string found = there ? "\"" + table.header.cells[i].text + "\"" : "missing";
    return refusal(table.file, table.header.line, there ? table.header.cells[i].column : 1, ErrorKind::syntax,
                   "header column " + std::to_string(i + 1) + " is " + found + ", expected " + dh_header[i]);
  }
  return {};
}

}  // namespace

Result<Chain> read_dh_chain(const std::string& file) {
  Result<Table> read = read_table(file);
  if (!read) return read.error();
  const Table& table = *read;
  if (auto fault = check_header(table)) return *fault;
  ChainBuilder builder(file);
  std::optional<Pose> base, tool;
  std::set<std::string> names;
  int count = 0;
  for (const Row& row : table.rows) {
    const std::string& name = row.cells[0].text;
    if (!names.insert(name).second)
      return refusal(file, row.line, 1, ErrorKind::exists, "\"" + name + "\" stands twice");
    if (name == "base" || name == "tool") {
      const Result<Pose> X = read_pose(table, row);
      if (!X) return X.error();
      if (name == "base" && count > 0) {
        return refusal(file, row.line, 1, ErrorKind::syntax,
                       "the base row stands after a joint, expected before the first");
      }
      if (name == "base") builder.fix(*X);
      if (name == "tool") tool = *X;
      continue;
    }
    if (row.cells.size() != dh_header.size()) {
      return refusal(file, row.line, 1, ErrorKind::syntax,
                     "joint \"" + name + "\" has " + std::to_string(row.cells.size()) + " cells, expected 8");
    }
    std::array<double, 8> v{};
    for (int i = 1; i < 8; ++i) {
      const Result<double> value = number(table, row, row.cells[i], std::string(dh_header[i]) + " of \"" + name + "\"");
      if (!value) return value.error();
      v[i] = *value;
      if (std::abs(v[i]) > largest) {
        return refusal(
            file, row.line, row.cells[i].column, ErrorKind::range,
            std::string(dh_header[i]) + " of \"" + name + "\" is " + row.cells[i].text + ", expected within 1e9");
      }
    }
    if (v[5] > v[6]) {
      return refusal(file, row.line, row.cells[5].column, ErrorKind::range,
                     "lower_deg of \"" + name + "\" is " + row.cells[5].text + ", expected at most upper_deg " +
                         row.cells[6].text);
    }
    if (v[7] < v[5] || v[7] > v[6]) {
      return refusal(file, row.line, row.cells[7].column, ErrorKind::range,
                     "rest_deg of \"" + name + "\" is " + row.cells[7].text + ", expected within its limits " +
                         row.cells[5].text + " .. " + row.cells[6].text);
    }
    if (++count > max_joints) {
      return refusal(file, row.line, 1, ErrorKind::limit, "more than " + std::to_string(max_joints) + " joints");
    }
    builder.dh(name, radians(v[1]), v[2], v[3], radians(v[4]), radians(v[5]), radians(v[6]), radians(v[7]));
  }
  if (count == 0)
    return refusal(file, table.header.line, 1, ErrorKind::syntax, "the table has no joints, expected at least one");
  if (tool) builder.fix(*tool);
  return builder.finish();
}

}  // namespace kinematics
