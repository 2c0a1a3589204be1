#include "manipulators/face_fem/solve_command.h"

#include <cstdarg>
#include <cstdio>

#include "manipulators/face_fem/blas_setup.h"
#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/inp_file.h"
#include "manipulators/face_fem/neo_hookean.h"
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

/// what a solver answered, linear or not
struct Answer {
  Field u;
  std::string status;  // one word, then what it means
  double residual = 0;
  std::vector<std::string> lines;  // of the summary, solver's own
};

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  char buffer[256];
  va_list values;
  va_start(values, format);
  std::vsnprintf(buffer, sizeof buffer, format, values);
  va_end(values);
  return buffer;
}

Result<Answer> solve_linear(const Model& model, const Field& load) {
  auto statics = Statics::make(model);
  if (!statics) return statics.error();
  const Solution solution = statics->solve(load);
  const FactorCost& cost = statics->factor().cost();
  return Answer{solution.u,
                "ok",
                solution.residual,
                {text("condition  %.2g (reciprocal)", statics->factor().rcond()),
                 text("stages_ms  assemble %.1f order %.1f factor %.1f solve %.2f (CPU, %s kernels)",
                      1e3 * statics->assemble_seconds(), 1e3 * cost.order_seconds, 1e3 * cost.factor_seconds,
                      1e3 * solution.seconds, blas_kernels())}};
}

Result<Answer> solve_nonlinear(const Model& model, const Field& load) {
  auto solution = solve_neo_hookean(model, load, given_shifts(model));
  if (!solution) return solution.error();
  return Answer{solution->u,
                std::string(name_of(solution->status)),
                solution->residual,
                {text("reached    %.3g of load and shift in %d increments, %d iterations", solution->reached,
                      solution->increments, solution->iterations)}};
}

void summarise(std::FILE* to, const Model& model, const Answer& answer, const Validity& validity, double seconds) {
  int free = 0, largest = 0;
  for (const auto& held : held_axes(model))
    for (bool axis : held) free += !axis;
  for (int n = 0; n < int(answer.u.cols()); ++n)
    if (answer.u.col(n).norm() > answer.u.col(largest).norm()) largest = n;
  std::fprintf(to, "status     %s\n", answer.status.c_str());
  std::fprintf(to, "elements   %zu %s\n", model.hexahedra.size(), name_of(model.element).data());
  std::fprintf(to, "nodes      %zu, %d free degrees of freedom\n", model.nodes.size(), free);
  std::fprintf(to, "largest    %.6g m at node %d\n", answer.u.col(largest).norm(), model.label_of_node(largest));
  std::fprintf(to, "strain     %.3g, volume change %.3g %%\n", validity.strain, 100 * validity.volume);
  std::fprintf(to, "residual   %.2g\n", answer.residual);
  for (const std::string& line : answer.lines) std::fprintf(to, "%s\n", line.c_str());
  std::fprintf(to, "cpu_ms     %.1f\n", 1e3 * seconds);
}

/// loads on nodes of no element would vanish without a word
Status check_loads(const Model& model, const Field& load) {
  for (int node : unused_nodes(model))
    if (load.col(node).squaredNorm() > 0)
      return Error{Fault::load,
                   "node " + std::to_string(model.label_of_node(node)) + " carries a load but belongs to no element"};
  return success();
}

/// the job's model with the element that was asked for
Status choose_element(Model& model, std::optional<Element> element) {
  if (!element) return success();
  if (nodes_of(*element) != nodes_of(model.element))
    return Error{Fault::element, "its elements have " + std::to_string(nodes_of(model.element)) + " nodes, which " +
                                     std::string(name_of(*element)) + " cannot use"};
  model.element = *element;
  return success();
}

/// the word of a linear answer, and sentences for what is beyond it
std::vector<std::string> judge(const Model& model, const Validity& validity, bool nonlinear, Answer& answer) {
  std::vector<std::string> warnings = nonlinear ? std::vector<std::string>{} : warnings_of(model, validity);
  if (!nonlinear) answer.status = validity.word();
  if (nonlinear && validity.inverted > 0)
    warnings.push_back(text("%d elements are turned inside out, the first is %d", validity.inverted,
                            model.label_of_hexahedron(validity.inverted_element)));
  const std::vector<TurnedCorner> turned = turned_corners(model);
  if (turned.empty()) return warnings;
  if (answer.status == "ok") answer.status = "turned_corner";
  warnings.push_back(
      text("the Jacobian of element %d must be positive at its node %d, is %.3g m3 (%zu such elements; "
           "solved, because their integration points are positive)",
           model.label_of_hexahedron(turned[0].hexahedron), model.label_of_node(turned[0].node), turned[0].det,
           turned.size()));
  return warnings;
}

}  // namespace

int run_solve(const SolveRequest& request) {
  const double begin = cpu_seconds();
  auto job = read_inp(request.model);
  if (!job) return refuse(job.error());
  const std::string file = request.model + ": ";
  if (!job->has_step)
    return refuse({Fault::truncated, "has no *STEP ... *END STEP, so nothing says what to solve"}, file);
  Model& model = job->model;
  if (auto status = choose_element(model, request.element); !status) return refuse(status.error(), file);
  if (auto status = check_loads(model, job->load); !status) return refuse(status.error(), file);
  auto answer = request.nonlinear ? solve_nonlinear(model, job->load) : solve_linear(model, job->load);
  if (!answer) return refuse(answer.error(), file);
  if (!answer->u.allFinite()) return refuse({Fault::not_finite, "the answer is not finite"}, file);
  const StressField stress = request.stress ? stress_field(model, answer->u) : StressField(6, 0);
  const Validity validity = validity_of(model, answer->u);
  const std::vector<std::string> warnings = judge(model, validity, request.nonlinear, *answer);

  const bool to_file = !request.out.empty();
  const TextFile csv = table(model, answer->u, stress);
  if (to_file) {
    if (auto status = csv.write(request.out); !status) return refuse(status.error());
  } else {
    std::fwrite(csv.text().data(), 1, csv.text().size(), stdout);
  }
  if (!request.vtu.empty())
    if (auto status = write_vtu(request.vtu, model, answer->u, stress); !status) return refuse(status.error());
  summarise(to_file ? stdout : stderr, model, *answer, validity, cpu_seconds() - begin);
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "face_fem: warning %s: %s\n", answer->status.c_str(), warning.c_str());
  return 0;
}

}  // namespace face
