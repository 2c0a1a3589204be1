#include "manipulators/face_fem/build_command.h"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/face_scan.h"
#include "manipulators/face_fem/face_sheet.h"
#include "manipulators/face_fem/inp_file.h"
#include "manipulators/face_fem/landmarks.h"
#include "manipulators/face_fem/neo_hookean.h"
#include "manipulators/face_fem/quadrature.h"
#include "manipulators/face_fem/range_scan.h"
#include "manipulators/face_fem/statics.h"
#include "manipulators/face_fem/validity.h"
#include "manipulators/face_fem/vtu_file.h"
#include "manipulators/mesh/read.h"
#include "manipulators/mesh/write.h"

namespace face {
namespace {

int refuse(const Error& error) {
  std::fprintf(stderr, "face_fem: error %s %s\n", std::string(name_of(error.fault)).c_str(), error.sentence.c_str());
  return 1;
}

/// numbers between separators; empty when one is none
std::vector<double> numbers(const std::string& text, char separator) {
  std::vector<double> found;
  const char *at = text.data(), *end = at + text.size();
  while (at <= end) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (next != end && *next != separator)) return {};
    found.push_back(value);
    at = next + 1;
  }
  return found;
}

Result<FaceOptions> options_of(const BuildRequest& request) {
  FaceOptions options;
  if (!request.resolution.empty()) {
    const std::vector<double> n = numbers(request.resolution, 'x');
    if (n.empty() || n.size() > 3)
      return Error{Fault::syntax,
                   "--resolution: N, COLUMNSxROWS or COLUMNSxROWSxLAYERS expected, is '" + request.resolution + "'"};
    options.columns = int(n[0]);
    options.rows = int(n.size() > 1 ? n[1] : n[0]);
    if (n.size() > 2) options.layers = int(n[2]);
  }
  for (const std::string& word : request.landmarks) {
    const std::size_t equals = word.find('=');
    const std::vector<double> p =
        equals == std::string::npos ? std::vector<double>() : numbers(word.substr(equals + 1), ',');
    if (p.size() != 3) return Error{Fault::syntax, "--landmark: NAME=x,y,z expected, is '" + word + "'"};
    options.landmarks[word.substr(0, equals)] = {p[0], p[1], p[2]};
  }
  return options;
}

Result<mesh::Surface> read_head(const BuildRequest& request) {
  const std::string& path = request.head;
  mesh::Surface surface;
  if (path.size() > 4 && path.substr(path.size() - 4) == ".vtk") {
    auto scan = read_range_scan(path);
    if (!scan) return scan.error();
    surface = std::move(*scan);
  } else {
    auto read = mesh::read_surface(path);
    if (!read) {
      const Fault fault = read.error().kind == "io"      ? Fault::io
                          : read.error().kind == "range" ? Fault::not_finite
                                                         : Fault::syntax;
      return Error{fault, read.error().sentence};
    }
    surface = std::move(*read);
  }
  if (!(request.unit > 0) || !std::isfinite(request.unit)) return Error{Fault::limit, "--unit must be positive"};
  surface.V *= float(request.unit);
  return surface;
}

/// amounts of face.muscles from words NAME=AMOUNT
Result<std::vector<double>> amounts_of(const Face& face, const std::vector<std::string>& words) {
  std::vector<double> amounts(face.muscles.size(), 0);
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const std::vector<double> value =
        equals == std::string::npos ? std::vector<double>{1} : numbers(word.substr(equals + 1), ',');
    if (value.size() != 1 || !std::isfinite(value[0]))
      return Error{Fault::syntax, "--muscle: NAME=AMOUNT expected, is '" + word + "'"};
    const std::string name = word.substr(0, equals);
    bool found = false;
    for (const std::string prefix : {"", "left_", "right_"})
      if (const int k = face.muscle(prefix + name); k >= 0) amounts[k] = value[0], found = true;
    if (!found) return Error{Fault::unknown, "no muscle is called '" + name + "'; --list names them"};
  }
  return amounts;
}

void turn_jaw(const Face& face, double degrees, Model& model) {
  const Eigen::AngleAxisd turn(degrees * M_PI / 180, face.jaw.axis);
  for (Support& s : model.supports) {
    if (s.bone != face.jaw_bone) continue;
    const Eigen::Vector3d arm = model.nodes[s.node] - face.jaw.centre;
    s.shift = turn * arm - arm;
  }
}

void list(const Face& face) {
  for (const Landmark& l : face.landmarks)
    std::printf("landmark %-21s %8.4f %8.4f %8.4f  %.2f %s\n", l.name.c_str(), l.place.x(), l.place.y(), l.place.z(),
                l.confidence, l.source.c_str());
  for (std::size_t k = 0; k < face.muscles.size(); ++k) {
    double force = 0;
    for (const Strand& s : face.muscles[k].strands) force += s.force;
    std::printf("muscle %-33s %2zu strands %6.2f N %5.1f mm2 %s\n", face.muscles[k].name.c_str(),
                face.muscles[k].strands.size(), force, face.muscle_notes[k].cross_section * 1e6,
                face.muscle_notes[k].source == MuscleSource::published ? "published" : "anatomy");
  }
}

struct Answer {
  Field u;
  std::string status = "ok";
};

/// the displacement asked for
Result<Answer> moved(const Model& model, const Field& load, bool nonlinear) {
  if (nonlinear) {
    const auto found = solve_neo_hookean(model, load, given_shifts(model));
    if (!found) return found.error();
    return Answer{found->u, found->status == Convergence::converged ? "ok" : std::string(name_of(found->status))};
  }
  const auto statics = Statics::make(model);
  if (!statics) return statics.error();
  Answer answer;
  answer.u = statics->solve(load).u;
  const Validity validity = validity_of(model, answer.u);
  answer.status = validity.word();
  for (const std::string& warning : warnings_of(model, validity))
    std::fprintf(stderr, "face_fem: warning %s: %s\n", answer.status.c_str(), warning.c_str());
  return answer;
}

void carry(const Face& face, const Field& u, mesh::Surface& surface) {
  std::vector<float> nodes, vertices(3 * face.carrier.vertices().size());
  for (int n : face.carrier.nodes())
    for (int i = 0; i < 3; ++i) nodes.push_back(float(u(i, n)));
  face.carrier.carry(nodes.data(), vertices.data());
  for (std::size_t k = 0; k < face.carrier.vertices().size(); ++k)
    for (int i = 0; i < 3; ++i) surface.V(face.carrier.vertices()[k], i) += vertices[3 * k + i];
}

Status write_head_scan(const mesh::Surface& surface, const FaceOptions& options, const std::string& path) {
  const auto head = Head::take(surface);
  if (!head) return head.error();
  const auto marks = find_landmarks(*head, options.landmarks);
  if (!marks) return marks.error();
  const auto sheet = lay_sheet(*head, *marks, options.columns, options.rows);
  if (!sheet) return sheet.error();
  return write_scan(path, scan_face(*head, sheet->chart, 0.0015));
}

}  // namespace

int run_build(const BuildRequest& request) {
  const auto options = options_of(request);
  if (!options) return refuse(options.error());
  auto surface = read_head(request);
  if (!surface) return refuse(surface.error());
  const double begin = cpu_seconds();
  const auto face = build_face(*surface, *options);
  if (!face) return refuse(face.error());
  const double built = cpu_seconds() - begin;
  const auto amounts = amounts_of(*face, request.muscles);
  if (!amounts) return refuse(amounts.error());
  if (!request.scan.empty())
    if (auto status = write_head_scan(*surface, *options, request.scan); !status) return refuse(status.error());

  Model model = face->model;
  Field load = Field::Zero(3, Eigen::Index(model.nodes.size()));
  const ElementBoxes boxes(model);
  bool moves = request.jaw != 0;
  for (std::size_t k = 0; k < amounts->size(); ++k) {
    if ((*amounts)[k] == 0) continue;
    const auto pull = load_of(model, boxes, face->muscles[k]);
    if (!pull) return refuse(pull.error());
    load += (*amounts)[k] * pull->load;
    moves = true;
  }
  if (request.jaw != 0) turn_jaw(*face, request.jaw, model);
  if (!request.write.empty())
    if (auto status = write_inp(request.write, model, load); !status) return refuse(status.error());

  Answer answer;
  answer.u = Field::Zero(3, Eigen::Index(model.nodes.size()));
  const bool solve = moves && !(request.vtu.empty() && request.surface.empty());
  if (solve) {
    auto found = moved(model, load, request.nonlinear);
    if (!found) return refuse(found.error());
    answer = std::move(*found);
  }
  if (!request.vtu.empty())
    if (auto status = write_vtu(request.vtu, model, answer.u); !status) return refuse(status.error());
  if (!request.surface.empty()) {
    carry(*face, answer.u, *surface);
    if (auto written = mesh::write_surface(request.surface, *surface); !written)
      return refuse({Fault::io, written.error().sentence});
  }

  if (request.list) list(*face);
  std::printf("status     %s\n", answer.status.c_str());
  std::printf("elements   %zu %s\n", model.hexahedra.size(), std::string(name_of(model.element)).c_str());
  std::printf("nodes      %zu, %zu held\n", model.nodes.size(), model.supports.size());
  std::printf("muscles    %zu\n", face->muscles.size());
  std::printf("vertices   %zu of %ld follow\n", face->carrier.vertices().size(), long(surface->V.rows()));
  if (solve) std::printf("largest    %.3g m\n", answer.u.colwise().norm().maxCoeff());
  std::printf("build_ms   %.0f (CPU)\n", 1e3 * built);
  for (const std::string& note : face->notes) std::fprintf(stderr, "face_fem: note: %s\n", note.c_str());
  return 0;
}

}  // namespace face
