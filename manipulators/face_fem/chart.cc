#include "manipulators/face_fem/chart.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>

#include "manipulators/face_fem/grid.h"
#include "manipulators/face_fem/measured_cap.h"
#include "manipulators/face_fem/neo_hookean.h"
#include "manipulators/face_fem/skin_carrier.h"
#include "manipulators/face_fem/text_file.h"
#include "manipulators/face_fem/validity.h"

namespace face {
namespace {

constexpr int samples = 40;  // a side of the grid on which surfaces are compared

/// rows of a table; numbers with six digits
class Table {
 public:
  explicit Table(const char* header) { file_.add(header).add("\n"); }
  Table& cell(std::string_view text) {
    if (started_) file_.add(",");
    started_ = true;
    file_.add(text);
    return *this;
  }
  Table& cell(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", number);
    return cell(std::string_view(text));
  }
  void end() {
    file_.add("\n");
    started_ = false;
  }
  const TextFile& file() const { return file_; }

 private:
  TextFile file_;
  bool started_ = false;
};

/// sum of the loads of all muscles at activation 1; empty when one cannot be placed
Result<Field> total_load(const Model& model, const std::vector<Muscle>& muscles, const SpreadOptions& options) {
  const ElementBoxes boxes(model);
  Field load = Field::Zero(3, int(model.nodes.size()));
  for (const Muscle& muscle : muscles) {
    auto one = load_of(model, boxes, muscle, options);
    if (!one) return one.error();
    load += one->load;
  }
  return load;
}

int free_axes(const Statics& statics) {
  int count = 0;
  for (const auto& held : statics.held())
    for (bool axis : held) count += !axis;
  return count;
}

/// the surface of the finest mesh, for each Poisson ratio
Eigen::Matrix3Xd reference_surface(double poisson) {
  const Mesh mesh{40, 40, 6};
  auto statics = Statics::make(cap(Element::hex20r, mesh.nx, mesh.ny, mesh.nz, poisson));
  SpreadOptions fine;
  fine.fineness = 6;
  const Field load = *total_load(statics->model(), cap_muscles(6, 0.006), fine);
  return surface_samples(statics->model(), mesh, statics->solve(load).u, samples);
}

void element_row(Table& table, Element element, const Mesh& mesh, Quadrature quadrature,
                 const Eigen::Matrix3Xd& reference) {
  table.cell(name_of(element)).cell(mesh.name()).cell(quadrature == Quadrature::octree ? "octree" : "gauss27");
  auto statics = Statics::make(cap(element, mesh.nx, mesh.ny, mesh.nz));
  SpreadOptions options;
  options.quadrature = quadrature;
  Result<Field> load =
      statics ? total_load(statics->model(), cap_muscles(6, 0.006), options) : Result<Field>(statics.error());
  if (!load) {
    table.cell("nan").cell("nan").cell("nan").cell("nan").cell("nan").cell("nan").cell(name_of(load.error().fault));
    return table.end();
  }
  const Field u = statics->solve(*load).u;
  const FactorCost& cost = statics->factor().cost();
  table.cell(free_axes(*statics))
      .cell(relative_difference(surface_samples(statics->model(), mesh, u, samples), reference))
      .cell(1e3 * statics->assemble_seconds())
      .cell(1e3 * cost.order_seconds)
      .cell(1e3 * cost.factor_seconds)
      .cell(best_ms(0.05, [&] { statics->factor().solve(*load); }))
      .cell("ok")
      .end();
}

TextFile elements() {
  Table table("element,mesh,quadrature,free_axes,error,assemble_ms,order_ms,factor_ms,solve_ms,status");
  const Eigen::Matrix3Xd reference = reference_surface(0.45);
  const Mesh meshes8[] = {{8, 8, 3}, {12, 12, 3}, {16, 16, 3}, {24, 24, 3}, {32, 32, 6}};
  const Mesh meshes20[] = {{4, 4, 3}, {8, 8, 3}, {12, 12, 3}, {16, 16, 3}, {24, 24, 3}};
  for (Element element : all_elements)
    for (const Mesh& mesh : nodes_of(element) == 8 ? meshes8 : meshes20)
      element_row(table, element, mesh, Quadrature::octree, reference);
  // the paper's rule, where spheres are missed or doubled
  for (const Mesh& mesh : {Mesh{8, 8, 3}, Mesh{16, 16, 3}})
    element_row(table, Element::bbar, mesh, Quadrature::gauss27, reference);
  for (const Mesh& mesh : {Mesh{4, 4, 3}, Mesh{12, 12, 3}})
    element_row(table, Element::hex20r, mesh, Quadrature::gauss27, reference);
  return table.file();
}

struct RuleChoice {
  const char* name;
  Quadrature quadrature;
  Weight weight;
  double fineness;
};

void quadrature_row(Table& table, const RuleChoice& rule, double ratio) {
  const Model model = grid(Element::bbar, 9, 9, 9, [](const Eigen::Vector3d& p) { return Eigen::Vector3d(9 * p); });
  const ElementBoxes boxes(model);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(4, 5);
  SpreadOptions options{rule.weight, rule.quadrature, rule.fineness};
  constexpr int tries = 200;
  double mean = 0, worst = 0, apart = 0, points = 0;
  int missed = 0, hit = 0;
  const double begin = cpu_seconds();
  for (int k = 0; k < tries; ++k) {
    const Eigen::Vector3d centre(place(random), place(random), place(random));
    const auto result = spread(model, boxes, centre, ratio, options);
    if (!result) {
      ++missed;
      mean += 1;
      worst = std::max(worst, 1.0);
      continue;
    }
    const double error = std::abs(result->total - 1);
    mean += error;
    worst = std::max(worst, error);
    apart += (result->centroid - centre).norm() / ratio;
    points += result->points;
    ++hit;
  }
  const double elapsed = cpu_seconds() - begin;
  table.cell(rule.name).cell(ratio).cell(mean / tries).cell(worst).cell(double(missed) / tries);
  table.cell(hit > 0 ? apart / hit : NAN).cell(hit > 0 ? points / hit : 0).cell(1e6 * elapsed / tries);
  table.cell(missed > 0 ? name_of(Fault::missed_sphere) : "ok").end();
}

TextFile quadratures() {
  Table table("rule,radius_over_h,force_error_mean,force_error_max,missed,centroid_error_radii,points,cost_us,status");
  const RuleChoice rules[] = {{"gauss27 sharp", Quadrature::gauss27, Weight::uniform, 0},
                              {"gauss27 smooth", Quadrature::gauss27, Weight::smooth, 0},
                              {"octree 1.5", Quadrature::octree, Weight::uniform, 1.5},
                              {"octree 3", Quadrature::octree, Weight::uniform, 3}};
  for (const RuleChoice& rule : rules)
    for (double ratio : {.05, .1, .2, .3, .5, .75, 1.0, 1.5, 2.0, 3.0}) quadrature_row(table, rule, ratio);
  return table.file();
}

double largest_of(const std::vector<float>& values) {
  double largest = 0;
  for (float value : values) largest = std::max(largest, double(std::abs(value)));
  return largest;
}

/// one mesh: every way to find 20 000 vertices for 36 muscles
void frame_rows(Table& table, const Mesh& mesh) {
  constexpr int vertices = 20000, muscles = 36;
  auto statics = Statics::make(cap(Element::bbar, mesh.nx, mesh.ny, mesh.nz));
  const Model& model = statics->model();
  const ElementBoxes boxes(model);
  std::vector<Field> loads;
  for (const Muscle& muscle : cap_muscles(muscles, 0.006)) loads.push_back(load_of(model, boxes, muscle)->load);
  const std::vector<int> nodes = skin_nodes(model);
  Basis basis(*statics, nodes);
  const double begin = cpu_seconds();
  basis.add(loads);
  const double built = 1e3 * (cpu_seconds() - begin);
  auto carrier = SkinCarrier::bind(model, cap_vertices(vertices));
  std::vector<float> at_nodes(3 * nodes.size()), exact(3 * vertices), moved(3 * vertices);

  std::vector<double> amounts(muscles);
  for (int k = 0; k < muscles; ++k) amounts[k] = 0.5 + 0.5 * std::sin(k);
  Field load = Field::Zero(3, int(model.nodes.size()));
  for (int k = 0; k < muscles; ++k) load += amounts[k] * loads[k];
  const auto carry_field = [&](const Field& u, std::vector<float>& out) {
    for (std::size_t k = 0; k < nodes.size(); ++k)
      for (int i = 0; i < 3; ++i) at_nodes[3 * k + i] = float(u(i, nodes[k]));
    carrier->carry(at_nodes.data(), out.data());
  };
  carry_field(statics->factor().solve(load), exact);
  const double size = largest_of(exact);
  const auto row = [&](const char* method, int active, double ms, bool same_amounts) {
    double apart = 0;
    for (int k = 0; same_amounts && k < 3 * vertices; ++k)
      apart = std::max(apart, double(std::abs(moved[k] - exact[k])));
    table.cell(method).cell(mesh.name()).cell(active).cell(ms).cell(same_amounts ? apart / size : 0).cell(built).end();
  };
  double ms = best_ms(0.1, [&] { carry_field(statics->factor().solve(load), moved); });
  row("solve double", muscles, ms, true);
  ms = best_ms(0.1, [&] { carry_field(statics->factor().solve_single(load), moved); });
  row("solve single", muscles, ms, true);
  const auto frame = [&] {
    basis.frame(amounts.data(), at_nodes.data());
    carrier->carry(at_nodes.data(), moved.data());
  };
  ms = best_ms(0.1, frame);
  row("basis", muscles, ms, true);
  for (int k = 6; k < muscles; ++k) amounts[k] = 0;
  ms = best_ms(0.1, frame);
  row("basis", 6, ms, false);
  const Muscle dragged = cap_muscles(1, 0.006)[0];
  ms = best_ms(0.1, [&] { basis.replace(0, load_of(model, boxes, dragged)->load); });
  row("drag one muscle", 1, ms, false);
}

TextFile frames() {
  Table table("method,mesh,active_muscles,frame_ms,error,basis_build_ms");
  for (const Mesh& mesh : {Mesh{8, 8, 3}, Mesh{16, 16, 4}, Mesh{32, 32, 6}}) frame_rows(table, mesh);
  return table.file();
}

TextFile locking() {
  Table table("element,mesh,poisson,largest_m,error,reciprocal_condition,status");
  const Mesh mesh{12, 12, 3}, finer{16, 16, 3};
  const double ratios[] = {.3, .45, .49, .499, .4999, .499999, .5};
  // reduced quadratic elements do not lock; on a finer mesh they are the reference
  std::vector<Eigen::Matrix3Xd> references;
  for (double poisson : ratios) {
    references.emplace_back();
    auto fine = Statics::make(cap(Element::hex20r, finer.nx, finer.ny, finer.nz, poisson));
    if (!fine) continue;
    const Field load = *total_load(fine->model(), cap_muscles(6, 0.006), {});
    references.back() = surface_samples(fine->model(), finer, fine->solve(load).u, samples);
  }
  for (Element element : all_elements)
    for (int k = 0; k < int(references.size()); ++k) {
      table.cell(name_of(element)).cell(mesh.name()).cell(ratios[k]);
      auto statics = Statics::make(cap(element, mesh.nx, mesh.ny, mesh.nz, ratios[k]));
      if (!statics) {
        table.cell("nan").cell("nan").cell("nan").cell(name_of(statics.error().fault)).end();
        continue;
      }
      const Field load = *total_load(statics->model(), cap_muscles(6, 0.006), {});
      const Field u = statics->solve(load).u;
      table.cell(u.colwise().norm().maxCoeff())
          .cell(relative_difference(surface_samples(statics->model(), mesh, u, samples), references[k]))
          .cell(statics->factor().rcond())
          .cell("ok")
          .end();
    }
  return table.file();
}

/// what is wrong with a model, and how it is told
TextFile refusals() {
  Table table("failure,status,reciprocal_condition");
  const auto row = [&](const char* failure, const Model& model) {
    auto statics = Statics::make(model);
    table.cell(failure).cell(statics ? "ok" : name_of(statics.error().fault));
    table.cell(statics ? statics->factor().rcond() : NAN).end();
  };
  const Model sound = cap(Element::bbar, 4, 4, 3);
  row("none", sound);
  const auto broken = [&](const char* failure, auto&& change) {
    Model model = sound;
    change(model);
    row(failure, model);
  };
  broken("Poisson's ratio 0.5", [](Model& m) { m.materials[1].poisson = 0.5; });
  broken("coordinate is not a number", [](Model& m) { m.nodes[7].x() = NAN; });
  broken("nothing held", [](Model& m) { m.supports.clear(); });
  broken("one node held", [](Model& m) { m.supports.resize(1); });
  broken("two nodes held", [](Model& m) { m.supports.resize(2); });
  broken("nodes listed inside out", [](Model& m) {
    for (int a = 0; a < 4; ++a) std::swap(m.hexahedra[3].node[a], m.hexahedra[3].node[a + 4]);
  });
  broken("node pushed through its element", [](Model& m) {
    const auto& node = m.hexahedra[47].node;
    m.nodes[node[6]] = 2 * m.nodes[node[0]] - m.nodes[node[6]];
  });
  broken("an element twice", [](Model& m) { m.hexahedra.push_back(m.hexahedra[20]); });
  // a straight row one element wide, which reduced integration cannot hold
  Model row_of_one =
      grid(Element::hex20r, 6, 1, 1, [](const Eigen::Vector3d& p) { return Eigen::Vector3d(6 * p.x(), p.y(), p.z()); });
  for (Hexahedron& h : row_of_one.hexahedra) h.layer = 0;
  row_of_one.materials = {{"tissue", 15e3, 0.45, 1040}};
  for (int node : nodes_of_sides(row_of_one, grid_sides(6, 1, 1, 0, false))) {
    Support support;
    support.node = node;
    row_of_one.supports.push_back(support);
  }
  row("hex20r in a row one element wide", row_of_one);
  row_of_one.element = Element::hex20;
  row("hex20 in the same row", row_of_one);
  return table.file();
}

TextFile nonlinear() {
  Table table("linear_peak_m,strain,turn_rad,inverted,difference,iterations,increments,linear_ms,nonlinear_ms,status");
  const Model model = cap(Element::bbar, 16, 16, 3);
  auto statics = Statics::make(model);
  const Muscle muscle = cap_muscles(1, 0.008)[0];
  const Field unit = load_of(model, ElementBoxes(model), muscle)->load;
  const Field linear = statics->solve(unit).u;
  const double solve_ms = best_ms(0.05, [&] { statics->factor().solve(unit); });
  for (double peak : {.001, .002, .004, .008, .012, .016, .024}) {
    const double scale = peak / linear.colwise().norm().maxCoeff();
    const Field none = Field::Zero(3, unit.cols());
    const auto large = solve_neo_hookean(model, scale * unit, none);
    const Validity validity = validity_of(model, scale * linear);
    table.cell(peak).cell(validity.strain).cell(validity.turn).cell(validity.inverted);
    if (!large) {
      table.cell("nan").cell("nan").cell("nan").cell(solve_ms).cell("nan").cell(name_of(large.error().fault)).end();
      continue;
    }
    table.cell((large->u - scale * linear).norm() / large->u.norm())
        .cell(large->iterations)
        .cell(large->increments)
        .cell(solve_ms)
        .cell(1e3 * large->seconds)
        .cell(large->status == Convergence::converged ? validity.word() : name_of(large->status))
        .end();
  }
  return table.file();
}

}  // namespace

int run_chart(const std::string& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) {
    std::fprintf(stderr, "face_fem: error io %s: cannot be made: %s\n", folder.c_str(), problem.message().c_str());
    return 1;
  }
  const struct {
    const char* name;
    TextFile (*measure)();
  } charts[] = {{"face_elements", elements}, {"face_quadrature", quadratures}, {"face_frames", frames},
                {"face_locking", locking},   {"face_nonlinear", nonlinear},    {"face_refusals", refusals}};
  for (const auto& chart : charts) {
    std::fprintf(stderr, "face_fem: measuring %s\n", chart.name);
    const std::string path = folder + "/" + chart.name + ".csv";
    if (auto status = chart.measure().write(path); !status) {
      std::fprintf(stderr, "face_fem: error io %s\n", status.error().sentence.c_str());
      return 1;
    }
  }
  return 0;
}

}  // namespace face
