#include "manipulators/arm_ik/solve_command.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <optional>

#include "manipulators/arm_ik/cpu_clock.h"
#include "manipulators/arm_ik/engine.h"
#include "manipulators/arm_ik/random.h"
#include "manipulators/kinematics/arm11.h"
#include "manipulators/kinematics/chain_file.h"
#include "manipulators/kinematics/table.h"

namespace arm_ik {

using kinematics::Chain;
using kinematics::refusal;
using objdb::Error;
using objdb::ErrorKind;
using objdb::Result;

namespace {

constexpr double unit_tolerance = 1e-2;
constexpr std::array<std::string_view, 3> built_in = {"arm11", "arm11_left", "arm11w"};

struct Target {
  Goal goal;
  std::vector<double> start;  // empty, or one value a joint
};

Result<Chain> read_chain(const SolveCommand& command) {
  if (command.chain == "arm11") return kinematics::arm11();
  if (command.chain == "arm11_left") return kinematics::arm11(kinematics::Side::left);
  if (command.chain == "arm11w") return kinematics::arm11(kinematics::Side::right, true);
  if (command.chain.ends_with(".urdf")) return kinematics::read_urdf_chain(command.chain, command.base, command.tip);
  return kinematics::read_dh_chain(command.chain);
}

// the header decides what a row holds: a place, a pose, or a pose and a start
Result<std::vector<Target>> read_targets(const std::string& file, int joints) {
  Result<kinematics::Table> read = kinematics::read_table(file);
  if (!read) return read.error();
  const kinematics::Table& table = *read;
  constexpr std::array<const char*, 7> names = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  const int columns = static_cast<int>(table.header.cells.size());
  for (int i = 0; i < std::min(columns, 7); ++i) {
    const kinematics::Cell& cell = table.header.cells[i];
    if (cell.text == names[i]) continue;
    return refusal(file, table.header.line, cell.column, ErrorKind::syntax,
                   "header column " + std::to_string(i + 1) + " is \"" + cell.text + "\", expected " + names[i]);
  }
  if (columns != 3 && columns != 7 && columns != 7 + joints) {
    return refusal(file, table.header.line, 1, ErrorKind::syntax,
                   "the header has " + std::to_string(columns) +
                       " columns, expected 3 (x,y,z), 7 (and qw,qx,qy,qz) or " + std::to_string(7 + joints) +
                       " (and a start of " + std::to_string(joints) + " joints)");
  }
  std::vector<Target> targets;
  for (const kinematics::Row& row : table.rows) {
    if (static_cast<int>(row.cells.size()) != columns) {
      return refusal(file, row.line, 1, ErrorKind::syntax,
                     "the row has " + std::to_string(row.cells.size()) + " cells, expected " + std::to_string(columns));
    }
    std::vector<double> v;
    for (int i = 0; i < columns; ++i) {
      const Result<double> value = kinematics::number(table, row, row.cells[i], table.header.cells[i].text);
      if (!value) return value.error();
      v.push_back(*value);
    }
    for (int i = 0; i < 3; ++i) {
      if (std::abs(v[i]) <= Goal::farthest) continue;
      return refusal(file, row.line, row.cells[i].column, ErrorKind::range,
                     table.header.cells[i].text + " is " + row.cells[i].text + ", expected within 1e9 m");
    }
    kinematics::Pose X;
    X.p = {v[0], v[1], v[2]};
    if (columns >= 7) {
      const Eigen::Vector4d wxyz(v[3], v[4], v[5], v[6]);
      if (std::abs(wxyz.norm() - 1) > unit_tolerance) {
        return refusal(file, row.line, row.cells[3].column, ErrorKind::range,
                       "the quaternion's length is " + std::to_string(wxyz.norm()) + ", expected 1");
      }
      X.R = kinematics::rotation_from_quaternion(wxyz);
    }
    targets.push_back({Goal(X, columns >= 7), {}});
    if (columns > 7) targets.back().start.assign(v.begin() + 7, v.end());
  }
  if (targets.empty())
    return refusal(file, table.header.line, 1, ErrorKind::syntax, "no targets, expected at least one row");
  return targets;
}

// shortest text that reads back to the same bits, whatever the locale
void append(std::string& line, double value) {
  char text[32];
  const auto [end, fault] = std::to_chars(text, text + sizeof text, value);
  line.append(text, end);
}

std::string header(const Chain& chain) {
  std::string line = "status,method,position_error_m,rotation_error_rad,iterations,time_us";
  for (int i = 0; i < chain.size(); ++i) {
    line += ",q" + std::to_string(i + 1) + (chain.joints[i].kind == kinematics::JointKind::turn ? "_rad" : "_m");
  }
  return line + "\n";
}

std::string row_of(const Solution& solution, double seconds, std::span<const double> q) {
  std::string line(name_of(solution.status));
  line += ',';
  line += name_of(solution.method);
  for (double value : {solution.position_error, solution.rotation_error}) {
    line += ',';
    append(line, value);
  }
  line += ',' + std::to_string(solution.iterations) + ',';
  char time[32];
  line.append(time, std::to_chars(time, time + sizeof time, seconds * 1e6, std::chars_format::fixed, 3).ptr);
  for (double value : q) {
    line += ',';
    append(line, value);
  }
  return line + "\n";
}

int fail(const Error& error) {
  std::cerr << error.sentence << "\n";
  return 1;
}

int usage(const std::string& sentence) {
  std::cerr << "arm_ik: " << sentence << "\n";
  return 2;
}

/// Says how far the work is, on a terminal only, a few times a second.
class Progress {
 public:
  explicit Progress(std::size_t total) : total_(total), shown_(isatty(STDERR_FILENO) != 0) {}
  void at(std::size_t done) {
    if (!shown_ || (done != total_ && done % 1024 != 0)) return;
    std::cerr << '\r' << done << " of " << total_ << " targets" << (done == total_ ? "\n" : "") << std::flush;
  }

 private:
  std::size_t total_;
  bool shown_;
};

}  // namespace

int run(const SolveCommand& command) {
  Method method;
  if (!method_named(command.method, method)) {
    return usage("--method is \"" + command.method + "\", expected one of: " + method_words());
  }
  const bool urdf = command.chain.ends_with(".urdf");
  if (urdf && (command.base.empty() || command.tip.empty()))
    return usage("a .urdf chain needs --base LINK and --tip LINK");
  if (!urdf && !(command.base.empty() && command.tip.empty()))
    return usage("--base and --tip name links of a .urdf chain, the chain is \"" + command.chain + "\"");
  if (!urdf && !command.chain.ends_with(".csv") &&
      std::find(built_in.begin(), built_in.end(), command.chain) == built_in.end()) {
    return usage("the chain is \"" + command.chain +
                 "\", expected a .csv or .urdf file or one of: arm11 arm11_left arm11w");
  }
  const Result<Chain> chain = read_chain(command);
  if (!chain) return fail(chain.error());
  Engine engine(*chain);
  if (std::string why_not; !engine.offers(method, why_not)) return usage("--method " + command.method + " " + why_not);
  const int n = chain->size();
  const Result<std::vector<Target>> targets = read_targets(command.targets, n);
  if (!targets) return fail(targets.error());
  if (command.start == "warm" && targets->front().start.empty()) {
    return fail(
        refusal(command.targets, 1, 1, ErrorKind::syntax, "--start warm needs a column for every joint's start"));
  }

  std::ofstream file;
  if (!command.out.empty()) {
    file.open(command.out, std::ios::binary);
    if (!file) return fail(refusal(command.out, 0, 0, ErrorKind::io, "cannot be written"));
  }
  std::ostream& out = command.out.empty() ? std::cout : file;
  out << header(*chain);
  SolveOptions options;
  options.position_tolerance = command.position_tolerance;
  options.rotation_tolerance = command.rotation_tolerance;
  options.budget = command.budget;
  options.seed = command.seed;
  Random random(command.seed);
  Progress progress(targets->size());
  std::vector<double> q(n);
  // tables belong to the chain, not to the first target
  engine.prepare(method);
  for (std::size_t k = 0; k < targets->size(); ++k) {
    const Target& target = (*targets)[k];
    for (int i = 0; i < n; ++i) {
      const kinematics::Joint& joint = chain->joints[i];
      q[i] = command.start == "random" ? random.between(joint.lower, joint.upper) : joint.rest;
      if (command.start == "warm") q[i] = target.start[i];
    }
    const double before = cpu_seconds();
    const Solution solution = engine.solve(method, target.goal, options, q);
    out << row_of(solution, cpu_seconds() - before, q);
    progress.at(k + 1);
  }
  out.flush();
  if (!out)
    return fail(
        refusal(command.out.empty() ? "standard output" : command.out, 0, 0, ErrorKind::io, "cannot be written"));
  return 0;
}

}  // namespace arm_ik
