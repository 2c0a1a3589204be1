#include "manipulators/face_fem/solve_command.h"

#include <cstdio>

#include "manipulators/face_fem/blas_setup.h"
#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/inp_file.h"
#include "manipulators/face_fem/statics.h"
#include "manipulators/face_fem/stress.h"
#include "manipulators/face_fem/text_file.h"
#include "manipulators/face_fem/validity.h"
#include "manipulators/face_fem/vtu_file.h"

namespace face {
namespace {

using StressField = Eigen::Matrix<double, 6, Eigen::Dynamic>;

int refuse(const Error& error, const std::string& about = "") {
  std::fprintf(stderr, "face_fem: error %s %s%s\n", name_of(error.fault).data(), about.c_str(), error.sentence.c_str());
  return 1;
}

TextFile table(const Model& model, const Field& u, const StressField& stress) {
  TextFile csv;
  csv.add("node,ux_m,uy_m,uz_m").add(stress.cols() > 0 ? ",sxx,syy,szz,sxy,syz,szx\n" : "\n");
  for (int n = 0; n < int(u.cols()); ++n) {
    csv.add(model.label_of_node(n));
    for (int i = 0; i < 3; ++i) csv.add(",").add(u(i, n));
    if (stress.cols() > 0)
      for (int i = 0; i < 6; ++i) csv.add(",").add(stress(i, n));
    csv.add("\n");
  }
  return csv;
}

void summarise(std::FILE* to, const Statics& statics, const Solution& solution, const Validity& validity, bool folded,
               double seconds) {
  const Model& model = statics.model();
  int free = 0, largest = 0;
  for (const auto& held : statics.held())
    for (bool axis : held) free += !axis;
  for (int n = 0; n < int(solution.u.cols()); ++n)
    if (solution.u.col(n).norm() > solution.u.col(largest).norm()) largest = n;
  const FactorCost& cost = statics.factor().cost();
  std::fprintf(to, "status     %s\n", validity.linear() && folded ? "turned_corner" : validity.word());
  std::fprintf(to, "elements   %zu %s\n", model.hexahedra.size(), name_of(model.element).data());
  std::fprintf(to, "nodes      %zu, %d free degrees of freedom\n", model.nodes.size(), free);
  std::fprintf(to, "largest    %.6g m at node %d\n", solution.u.col(largest).norm(), model.label_of_node(largest));
  std::fprintf(to, "strain     %.3g, volume change %.3g %%\n", validity.strain, 100 * validity.volume);
  std::fprintf(to, "residual   %.2g, reciprocal condition %.2g\n", solution.residual, statics.factor().rcond());
  std::fprintf(to, "cpu_ms     %.1f: assemble %.1f order %.1f factor %.1f solve %.2f (%s kernels)\n", 1e3 * seconds,
               1e3 * statics.assemble_seconds(), 1e3 * cost.order_seconds, 1e3 * cost.factor_seconds,
               1e3 * solution.seconds, blas_kernels());
}

}  // namespace

int run_solve(const SolveRequest& request) {
  const double begin = cpu_seconds();
  auto job = read_inp(request.model);
  if (!job) return refuse(job.error());
  if (!job->has_step)
    return refuse({Fault::truncated, "has no *STEP ... *END STEP, so nothing says what to solve"},
                  request.model + ": ");
  if (request.element) {
    if (nodes_of(*request.element) != nodes_of(job->model.element))
      return refuse({Fault::element, "its elements have " + std::to_string(nodes_of(job->model.element)) +
                                         " nodes, which " + std::string(name_of(*request.element)) + " cannot use"},
                    request.model + ": ");
    job->model.element = *request.element;
  }
  for (int node : unused_nodes(job->model)) {
    if (job->load.col(node).squaredNorm() > 0)
      return refuse({Fault::load, "node " + std::to_string(job->model.label_of_node(node)) +
                                      " carries a load but belongs to no element"},
                    request.model + ": ");
  }
  auto statics = Statics::make(std::move(job->model));
  if (!statics) return refuse(statics.error(), request.model + ": ");
  const Model& model = statics->model();
  const Solution solution = statics->solve(job->load);
  if (!solution.u.allFinite()) return refuse({Fault::not_finite, "the answer is not finite"}, request.model + ": ");
  const StressField stress = request.stress ? stress_field(model, solution.u) : StressField(6, 0);
  const Validity validity = validity_of(model, solution.u);

  const bool to_file = !request.out.empty();
  const TextFile csv = table(model, solution.u, stress);
  if (to_file) {
    if (auto status = csv.write(request.out); !status) return refuse(status.error());
  } else {
    std::fwrite(csv.text().data(), 1, csv.text().size(), stdout);
  }
  if (!request.vtu.empty())
    if (auto status = write_vtu(request.vtu, model, solution.u, stress); !status) return refuse(status.error());
  const std::vector<TurnedCorner> turned = turned_corners(model);
  summarise(to_file ? stdout : stderr, *statics, solution, validity, !turned.empty(), cpu_seconds() - begin);
  if (!turned.empty())
    std::fprintf(
        stderr,
        "face_fem: warning turned_corner: the Jacobian of element %d must be positive at its node %d, is %.3g m3 "
        "(%zu such elements; solved, because their integration points are positive)\n",
        model.label_of_hexahedron(turned[0].hexahedron), model.label_of_node(turned[0].node), turned[0].det,
        turned.size());
  for (const std::string& warning : warnings_of(model, validity))
    std::fprintf(stderr, "face_fem: warning %s: %s\n", validity.word(), warning.c_str());
  return 0;
}

}  // namespace face
