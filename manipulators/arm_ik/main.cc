#include <CLI/CLI.hpp>
#include <cstdlib>

#include "manipulators/arm_ik/arms.h"
#include "manipulators/arm_ik/chart.h"
#include "manipulators/arm_ik/figure_arm.h"
#include "manipulators/arm_ik/solve_command.h"
#include "objdb/unit.h"

namespace {

// a duration with an optional unit, as in the language: 1ms, 0.001
std::string read_duration(const std::string& text, double& seconds) {
  const auto value = objdb::parse_real(text, objdb::parse_unit("s")->dimension);
  if (!value) return value.error().sentence;
  if (!(*value > 0)) return "is " + text + ", expected more than 0";
  seconds = *value;
  return {};
}

// CLI11's own message prints the largest double in full
const CLI::Validator positive(
    [](const std::string& text) {
      return std::strtod(text.c_str(), nullptr) > 0 ? std::string() : "is " + text + ", expected more than 0";
    },
    "", "positive");

// CLI11 takes -1 for the largest number
const CLI::Validator natural(
    [](const std::string& text) {
      return text.starts_with('-') ? "is " + text + ", expected 0 or more" : std::string();
    },
    "", "natural");

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Inverse kinematics of arms, legs and any serial chain. Without options: a manipulator on standard input and "
      "output."};
  arm_ik::SolveCommand solve;
  std::vector<std::string> files;
  std::string budget = "1ms";
  auto* solving = app.add_option("--solve", files,
                                 "solve a file of targets: CHAIN (.csv, .urdf, arm11, arm11_left, arm11w) TARGETS.csv")
                      ->expected(2)
                      ->type_name("CHAIN TARGETS");
  app.add_option("--base", solve.base, "first link of a .urdf chain")->needs(solving);
  app.add_option("--tip", solve.tip, "last link of a .urdf chain")->needs(solving);
  app.add_option("--method", solve.method, "auto limb rhythm full reach polish clamped")
      ->needs(solving)
      ->capture_default_str();
  app.add_option("--position-tolerance", solve.position_tolerance, "metres")
      ->needs(solving)
      ->check(positive)
      ->capture_default_str();
  app.add_option("--rotation-tolerance", solve.rotation_tolerance, "radians")
      ->needs(solving)
      ->check(positive)
      ->capture_default_str();
  app.add_option("--budget", budget, "work a target may cost, in nominal time")->needs(solving)->capture_default_str();
  app.add_option("--start", solve.start, "where a solve starts")
      ->needs(solving)
      ->check(CLI::IsMember({"rest", "random", "warm"}))
      ->capture_default_str();
  app.add_option("--seed", solve.seed, "of random starts")->needs(solving)->check(natural)->capture_default_str();
  app.add_option("--out", solve.out, "result file; standard output if not given")->needs(solving);
  std::string chart_folder;
  app.add_option("--chart", chart_folder, "measure all methods (and the peers that were built) into this folder");
  arm_ik::FigureArm figure;
  std::string side;
  std::vector<double> position{0, 0, 0};
  auto* drawing = app.add_option("--figure", side, "print the create lines of an arm of a figure")
                      ->check(CLI::IsMember({"right", "left"}));
  app.add_option("--actor", figure.actor, "whose arm")->needs(drawing)->capture_default_str();
  app.add_option("--parent", figure.parent, "what carries it, an object of the actor")
      ->needs(drawing)
      ->capture_default_str();
  app.add_option("--position", position, "of the top of the breastbone in the parent's frame, metres")
      ->needs(drawing)
      ->expected(3);
  app.add_option("--stature", figure.stature, "of the actor, metres")
      ->needs(drawing)
      ->check(positive)
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!files.empty()) {
    if (const std::string fault = read_duration(budget, solve.budget); !fault.empty()) {
      std::cerr << "arm_ik: --budget " << fault << "\n";
      return 2;
    }
    solve.chain = files[0];
    solve.targets = files[1];
    return arm_ik::run(solve);
  }
  if (!chart_folder.empty()) return arm_ik::chart(chart_folder);
  if (!side.empty()) {
    figure.side = side == "left" ? kinematics::Side::left : kinematics::Side::right;
    figure.position = {position[0], position[1], position[2]};
    std::cout << arm_ik::figure_script(figure);
    return 0;
  }
  return arm_ik::Arms().run();
}
