#include <CLI/CLI.hpp>
#include <cstdio>

#include "manipulators/head_ik/figure.h"

int main(int argc, char** argv) {
  CLI::App app{"head_ik: turns the head of a figure towards what it looks at"};
  std::string figure_neck;
  head::FigureNames names;
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!figure_neck.empty()) {
    const head::Neck neck = figure_neck == "full" ? head::full_neck(scale) : head::reduced_neck(scale);
    const Eigen::Vector3d centre(position[0], position[1], position[2]);
    std::fputs((as_table ? figure_table(neck, names) : figure_script(neck, names, centre)).c_str(), stdout);
  }
  return 0;
}
