#include <CLI/CLI.hpp>
#include <cstdio>

#include "manipulators/face_fem/blas_setup.h"
#include "manipulators/face_fem/chart.h"
#include "manipulators/face_fem/solve_command.h"

namespace {

int usage(const std::string& sentence) {
  std::fprintf(stderr, "face_fem: error usage %s\n", sentence.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  face::prepare_blas(argv);
  CLI::App app{"Facial tissue between bone and skin: finite elements, muscles, files."};
  face::SolveRequest solve;
  std::string element, chart;
  app.add_option("--solve", solve.model, "solve a static job in the Abaqus/CalculiX input format")
      ->type_name("MODEL.inp");
  app.add_option("--element", element,
                 "hex8, bbar, wt (8 nodes), hex20, hex20r (20 nodes); default: by TYPE in the file, C3D8 is bbar")
      ->check(CLI::IsMember({"hex8", "bbar", "wt", "hex20", "hex20r"}));
  auto* stress = app.add_flag("--stress", solve.stress, "also write nodal stress, pascals (linear only)");
  app.add_flag("--nonlinear", solve.nonlinear, "large deformation: neo-Hookean tissue (not with wt)")->excludes(stress);
  app.add_option("--out", solve.out, "table of displacements; default: standard output")->type_name("OUT.csv");
  app.add_option("--vtu", solve.vtu, "the same for ParaView")->type_name("OUT.vtu");
  app.add_option("--chart", chart, "measure error against cost and write tables")->type_name("DIR");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return usage(error.what());
  }
  if (!element.empty()) solve.element = face::element_named(element);
  if (!solve.model.empty()) return face::run_solve(solve);
  if (!chart.empty()) return face::run_chart(chart);
  return usage("nothing to do; see --help");
}
