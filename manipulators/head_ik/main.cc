#include <CLI/CLI.hpp>
#include <cstdio>

#include "manipulators/head_ik/chart.h"
#include "manipulators/head_ik/figure.h"
#include "manipulators/head_ik/heads.h"
#include "manipulators/head_ik/solve_command.h"

int main(int argc, char** argv) {
  CLI::App app{"head_ik: turns the head of a figure towards what it looks at.\nWithout options it is a manipulator."};
  std::string figure_neck, neck_kind = "full", method = "swing_twist";
  head::FigureNames names;
  head::SolveOptions solve;
  double scale = 1;
  bool as_table = false;
  std::vector<double> position{0, 0, 0};
  app.add_option("--figure-neck", figure_neck, "print the `create joint` lines of a neck")
      ->check(CLI::IsMember({"full", "reduced"}));
  app.add_option("--parent", names.parent, "the node below which the neck stands")->capture_default_str();
  app.add_option("--prefix", names.prefix, "before the names of the joints")->capture_default_str();
  app.add_option("--position", position, "centre of C7-T1 in the parent's frame [m]")->expected(3);
  app.add_option("--scale", scale, "size of the neck; 1 is a man of middle size")->check(CLI::PositiveNumber);
  app.add_flag("--table", as_table, "the rows as a table instead");

  std::string chart_folder;
  auto* charting =
      app.add_option("--chart", chart_folder, "measure what the charts show, into CSV files of this folder");
  auto* solving = app.add_option("--solve", solve.targets, "table of orientations (r11,...,r33) or points (x,y,z)");
  app.add_option("--out", solve.out, "where the answers go; standard output without it")->needs(solving);
  app.add_option("--neck", neck_kind, "whose limits")->check(CLI::IsMember({"full", "reduced"}))->needs(solving);
  app.add_option("--method", method, "swing_twist, or paper_zyz: the printed rule")
      ->check(CLI::IsMember({"swing_twist", "paper_zyz"}))
      ->needs(solving);
  app.add_option("--roll", solve.roll, "roll of a gaze: 1 Fick, 0 Listing")
      ->check(CLI::Range(0.0, 1.0))
      ->needs(solving);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  const auto make_neck = [&](const std::string& kind) {
    return kind == "full" ? head::full_neck(scale) : head::reduced_neck(scale);
  };
  if (!figure_neck.empty()) {
    const head::Neck neck = make_neck(figure_neck);
    const Eigen::Vector3d centre(position[0], position[1], position[2]);
    std::fputs((as_table ? figure_table(neck, names) : figure_script(neck, names, centre)).c_str(), stdout);
    return 0;
  }
  if (*solving) {
    solve.paper = method == "paper_zyz";
    return solve_command(make_neck(neck_kind), solve);
  }
  if (*charting) return head::chart_command(chart_folder);
  return head::Heads().run();
}
