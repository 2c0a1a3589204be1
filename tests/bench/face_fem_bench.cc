// What a face costs, beside what else could be done: CHOLMOD's own factorisation and solve, Eigen's, the memory and
// arithmetic limits of the machine, and CalculiX on the same file. CPU time of one thread, best of several; compare
// the ratios, which are taken in one run.
#include <unistd.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/face_fem/blas.h"
#include "manipulators/face_fem/blas_setup.h"
#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/grid.h"
#include "manipulators/face_fem/inp_file.h"
#include "manipulators/face_fem/measured_cap.h"
#include "manipulators/face_fem/skin_carrier.h"

namespace {

using namespace face;

/// a published face mesh from the reference data, or nothing
Model published_face() {
  const char* variable = std::getenv("SAILOR_DATA");
  const std::string folder =
      (variable != nullptr ? std::string(variable) : SOURCE_DIR "/../shared/data") + "/face_mesh/";
  Model model;
  std::ifstream nodes(folder + "newface.node"), bricks(folder + "newface.elem");
  for (std::string line; std::getline(nodes, line);) {
    std::istringstream words(line);
    int label;
    Eigen::Vector3d p;
    if (words >> label >> p.x() >> p.y() >> p.z()) model.nodes.push_back(p / 1000);
  }
  for (std::string line; std::getline(bricks, line);) {
    std::istringstream words(line);
    Hexahedron h;
    for (int a = 0; a < 8; ++a)
      if (words >> h.node[a]) --h.node[a];
    if (words) model.hexahedra.push_back(h);
  }
  for (const char* name : {"fixed_skull_nose.node", "fixed_mandible.node"}) {
    std::ifstream file(folder + name);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      Support support;
      if (words >> support.node) {
        --support.node;
        model.supports.push_back(support);
      }
    }
  }
  model.materials = {{"tissue", 15e3, .45, 1040}};
  return model;
}

/// gigabytes a second when `megabytes` are read over and over
double bandwidth(double megabytes) {
  std::vector<double> data(std::size_t(megabytes * 1e6 / 8), 1.0);
  volatile double sink = 0;
  const double ms = best_ms(0.1, [&] {
    double sum[16] = {};
    for (std::size_t k = 0; k + 16 <= data.size(); k += 16)
      for (int l = 0; l < 16; ++l) sum[l] += data[k + l];
    double total = 0;
    for (double s : sum) total += s;
    sink = sink + total;
  });
  return megabytes / 1e3 / (ms / 1e3);
}

/// gigaflops of dgemm on 512 x 512 matrices
double dgemm_rate() {
  const int n = 512;
  const double one = 1;
  std::vector<double> A(n * n, 0.5), B(n * n, 0.25), C(n * n, 0);
  const double ms =
      best_ms(0.2, [&] { dgemm_("N", "N", &n, &n, &n, &one, A.data(), &n, B.data(), &n, &one, C.data(), &n); });
  return 2.0 * n * n * n / ms / 1e6;
}

Eigen::SparseMatrix<double> to_eigen(const Statics& statics, std::vector<int>& number) {
  const Stiffness& K = statics.stiffness();
  number.assign(3 * std::size_t(K.nodes), -1);
  int count = 0;
  for (int n = 0; n < K.nodes; ++n)
    for (int i = 0; i < 3; ++i)
      if (!statics.held()[n][i]) number[3 * std::size_t(n) + i] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < K.nodes; ++c)
    for (int k = K.start[c]; k < K.start[c + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int row = number[3 * std::size_t(K.row[k]) + i], column = number[3 * std::size_t(c) + j];
          if (row >= 0 && column >= 0 && (K.row[k] > c || row >= column))
            entries.emplace_back(std::max(row, column), std::min(row, column), K.block[9 * std::size_t(k) + 3 * i + j]);
        }
  Eigen::SparseMatrix<double> A(count, count);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

void line(const char* what, double ms, const char* against = nullptr, double ratio = 0) {
  std::printf("  %-44s %9.3f ms", what, ms);
  if (against != nullptr) std::printf("   %6.2f x %s", ratio, against);
  std::printf("\n");
}

double gflops = 0;

void bench(const char* name, Model model, bool with_eigen) {
  const int elements = int(model.hexahedra.size());
  // muscles between random nodes of the tissue: what they cost does not depend on where they are
  std::vector<Muscle> muscles;
  const ElementBoxes boxes(model);
  for (int k = 0; k < 36; ++k) {
    const Hexahedron& h = model.hexahedra[std::size_t(k) * 7919 % elements];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int a = 0; a < 8; ++a) middle += model.nodes[h.node[a]] / 8;
    muscles.push_back({"m", {{middle + Eigen::Vector3d(.01, .002, -.003), middle, 0, .004, 1}}});
  }
  auto statics = Statics::make(model);
  if (!statics) {
    std::printf("%s: %s\n", name, statics.error().sentence.c_str());
    return;
  }
  const FactorCost cost = statics->factor().cost();
  std::printf("\n%s: %d elements, %zu nodes, %.2f M entries of L, %.2f Gflop\n", name, elements, model.nodes.size(),
              cost.nonzeros / 1e6, cost.flops / 1e9);

  const double check_ms = best_ms(0.1, [&] { (void)check(model); });
  const double assemble_ms = best_ms(0.1, [&] { (void)assemble(model); });
  double order_ms = 1e300, factor_ms = 1e300, cholmod_ms = 1e300;
  for (int run = 0; run < 4; ++run) {
    const auto ours = Factor::make(statics->stiffness(), statics->held());
    order_ms = std::min(order_ms, 1e3 * ours->cost().order_seconds);
    factor_ms = std::min(factor_ms, 1e3 * ours->cost().factor_seconds);
    const auto theirs = Factor::make(statics->stiffness(), statics->held(), {Order::metis, Elimination::cholmod});
    cholmod_ms = std::min(cholmod_ms, 1e3 * theirs->cost().factor_seconds);
  }
  std::vector<Field> loads;
  const double spread_ms = best_ms(0.05, [&] {
    loads.clear();
    for (const Muscle& muscle : muscles) loads.push_back(load_of(model, boxes, muscle)->load);
  });
  const double basis_ms = best_ms(0.1, [&] {
    Basis basis(*statics, skin_nodes(model));
    basis.add(loads);
  });
  line("check", check_ms);
  line("assemble", assemble_ms);
  line("order (METIS on nodes)", order_ms);
  line("factor", factor_ms, "dgemm's rate", factor_ms / (cost.flops / gflops / 1e6));
  line("  CHOLMOD supernodal, same order", cholmod_ms, "ours", cholmod_ms / factor_ms);
  line("spheres of 36 muscles", spread_ms);
  line("basis of 36 muscles", basis_ms);
  line("set-up: assemble, order, factor, muscles", assemble_ms + order_ms + factor_ms + spread_ms + basis_ms);

  const Field& load = loads[0];
  const double rate = bandwidth(cost.nonzeros * 8 / 1e6), limit = 2 * cost.nonzeros * 8 / rate / 1e6;
  const double rate4 = bandwidth(cost.nonzeros * 4 / 1e6), limit4 = 2 * cost.nonzeros * 4 / rate4 / 1e6;
  const double solve_ms = best_ms(0.2, [&] { (void)statics->factor().solve(load); });
  const double single_ms = best_ms(0.2, [&] { (void)statics->factor().solve_single(load); });
  line("solve", solve_ms, "reading L twice", solve_ms / limit);
  line("solve, single precision", single_ms, "reading it twice", single_ms / limit4);
  if (with_eigen) {
    std::vector<int> number;
    const Eigen::SparseMatrix<double> A = to_eigen(*statics, number);
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> eigen;
    const double begin = cpu_seconds();
    eigen.compute(A);
    const double eigen_ms = 1e3 * (cpu_seconds() - begin);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(A.rows());
    for (int k = 0; k < int(number.size()); ++k)
      if (number[k] >= 0) b[number[k]] = load.data()[k];
    const double eigen_solve = best_ms(0.1, [&] { b = eigen.solve(b).eval(); });
    line("  Eigen SimplicialLDLT, order and factor", eigen_ms, "ours", eigen_ms / (order_ms + factor_ms));
    line("  Eigen SimplicialLDLT, solve", eigen_solve, "ours", eigen_solve / solve_ms);
  }

  if (!model.skin.empty()) {
    Basis basis(*statics, skin_nodes(model));
    basis.add(loads);
    auto carrier = SkinCarrier::bind(model, cap_vertices(20000));
    std::vector<float> nodes(3 * basis.nodes().size()), vertices(60000);
    std::vector<double> amounts(36, 0.5);
    const double carry_ms = best_ms(0.05, [&] { carrier->carry(nodes.data(), vertices.data()); });
    const double frame_ms = best_ms(0.05, [&] {
      basis.frame(amounts.data(), nodes.data());
      carrier->carry(nodes.data(), vertices.data());
    });
    line("frame: 36 muscles, 20 000 vertices", frame_ms, "of a solve", frame_ms / solve_ms);
    line("  of which vertices", carry_ms);
  }
  Basis one(*statics, skin_nodes(model));
  one.add({load});
  line("drag a muscle: two spheres and a solve",
       best_ms(0.1, [&] { one.replace(0, load_of(model, boxes, muscles[1])->load); }));
  bool up = true;
  line("edit the stiffness of one element", best_ms(0.1, [&] {
         (void)statics->stiffen(elements / 2, up ? 2 : 0.5);
         up = !up;
       }));
}

/// read a file, solve, write a table: this program's engine against CalculiX, whole processes
void against_calculix(const char* name, const Model& model) {
  if (std::system("command -v ccx >/dev/null") != 0) return;
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("face_fem_bench_" + std::to_string(getpid()));
  fs::create_directories(folder);
  Field load = Field::Zero(3, int(model.nodes.size()));
  load.row(1).setConstant(-1e-4);
  for (const Support& s : model.supports) load.col(s.node).setZero();
  (void)write_inp((folder / "job.inp").string(), model, load);
  // user and system time of a child, from the shell
  const auto cpu = [&](const std::string& command) {
    double best = 1e300;
    for (int run = 0; run < 3; ++run) {
      const std::string timed = "cd " + folder.string() +
                                " && OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 bash -c 'TIMEFORMAT=\"%U %S\"; time " +
                                command + " >/dev/null 2>log' 2>times";
      if (std::system(timed.c_str()) != 0) return 0.0;
      double user = 0, system = 0;
      std::ifstream(folder / "times") >> user >> system;
      best = std::min(best, user + system);
    }
    return 1e3 * best;
  };
  const double ours = cpu(BIN_DIR "/face_fem --solve job.inp --element hex8 --out u.csv");
  const double theirs = cpu("ccx job");
  std::printf("\n%s, whole job, CPU: ours %.0f ms, CalculiX %.0f ms, ratio %.1f\n", name, ours, theirs, theirs / ours);
  fs::remove_all(folder);
}

}  // namespace

int main(int, char** argv) {
  prepare_blas(argv);
  gflops = dgemm_rate();
  std::printf("dgemm %.0f Gflop/s (%s kernels), one thread\n", gflops, blas_kernels());
  bench("cap 8x8x3", cap(Element::bbar, 8, 8, 3), true);
  bench("cap 16x16x4", cap(Element::bbar, 16, 16, 4), true);
  bench("cap 32x32x6", cap(Element::bbar, 32, 32, 6), false);
  if (Model published = published_face(); !published.nodes.empty()) bench("published face mesh", published, false);
  against_calculix("cap 16x16x4", cap(Element::hex8, 16, 16, 4));
  against_calculix("cap 32x32x6", cap(Element::hex8, 32, 32, 6));
}
