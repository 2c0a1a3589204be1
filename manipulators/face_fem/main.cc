#include <CLI/CLI.hpp>
#include <cstdio>

#include "manipulators/face_fem/blas_setup.h"
#include "manipulators/face_fem/build_command.h"
#include "manipulators/face_fem/chart.h"
#include "manipulators/face_fem/expression_check.h"
#include "manipulators/face_fem/faces.h"
#include "manipulators/face_fem/solve_command.h"

namespace {

int usage(const std::string& sentence) {
  std::fprintf(stderr, "face_fem: error usage %s\n", sentence.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  face::prepare_blas(argv);
  CLI::App app{
      "Facial tissue between bone and skin: finite elements, muscles, expressions.\n"
      "Without options it is a manipulator."};
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
  face::BuildRequest build;
  auto* head =
      app.add_option("--build", build.head, "build a face on a head: OBJ, PLY, STL, Collada, glTF, range scan (.vtk)")
          ->type_name("HEAD");
  app.add_option("--unit", build.unit, "metres in one unit of HEAD (0.01 for centimetres)")->needs(head);
  app.add_option("--resolution", build.resolution, "N, COLUMNSxROWS or COLUMNSxROWSxLAYERS; default 32x32x3")
      ->needs(head);
  app.add_option("--landmark", build.landmarks, "NAME=x,y,z in metres: a point that is known already")->needs(head);
  app.add_option("--muscle", build.muscles, "NAME=AMOUNT: contract it; without left_ or right_ both sides")
      ->needs(head);
  app.add_option("--jaw", build.jaw, "open the jaw, degrees")->needs(head);
  app.add_option("--scan", build.scan, "write the virtual range scan of the skin")->type_name("OUT.csv")->needs(head);
  app.add_option("--write", build.write, "write tissue and load for CalculiX")->type_name("MODEL.inp")->needs(head);
  app.add_option("--surface", build.surface, "write the head as it moves")->type_name("OUT.obj")->needs(head);
  app.add_flag("--list", build.list, "print landmarks and muscles")->needs(head);
  std::string compare;
  app.add_option("--compare", compare, "measure expressions against those known of HEAD: expression,vertex,dx,dy,dz")
      ->type_name("EXPRESSIONS.csv")
      ->needs(head);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return usage(error.what());
  }
  if (!element.empty()) solve.element = face::element_named(element);
  build.vtu = solve.vtu;
  build.nonlinear = solve.nonlinear;
  if (!compare.empty()) return face::run_compare({build.head, compare, build.unit});
  if (!build.head.empty()) return face::run_build(build);
  if (!solve.model.empty()) return face::run_solve(solve);
  if (!chart.empty()) return face::run_chart(chart);
  if (argc > 1) return usage("nothing to do; see --help");
  return face::Faces().run();
}
