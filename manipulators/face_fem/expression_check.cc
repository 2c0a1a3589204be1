#include "manipulators/face_fem/expression_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "manipulators/face_fem/actor.h"
#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/expressions.h"
#include "manipulators/face_fem/strength.h"
#include "manipulators/mesh/read.h"

namespace face {
namespace {

using Eigen::Vector3d;

// our units beside the shapes of ICT-FaceKit, which go by the names of ARKit's
struct Pairing {
  const char* name;
  std::vector<std::string_view> ours;
  std::vector<std::string> theirs;
};
const Pairing pairings[] = {
    {"smile", {"AU12"}, {"mouthSmile_L", "mouthSmile_R"}},
    {"frown", {"AU15"}, {"mouthFrown_L", "mouthFrown_R"}},
    {"brow_raise", {"AU1", "AU2"}, {"browInnerUp_L", "browInnerUp_R", "browOuterUp_L", "browOuterUp_R"}},
    {"brow_lower", {"AU4"}, {"browDown_L", "browDown_R"}},
    {"nose_wrinkle", {"AU9"}, {"noseSneer_L", "noseSneer_R"}},
    {"pucker", {"AU18"}, {"mouthPucker"}},
    {"stretch", {"AU20"}, {"mouthStretch_L", "mouthStretch_R"}},
    {"upper_lip_up", {"AU10"}, {"mouthUpperUp_L", "mouthUpperUp_R"}},
    {"lower_lip_down", {"AU16"}, {"mouthLowerDown_L", "mouthLowerDown_R"}},
    {"cheek_raise", {"AU6"}, {"cheekSquint_L", "cheekSquint_R"}},
    {"dimple", {"AU14"}, {"mouthDimple_L", "mouthDimple_R"}},
    {"blink", {"AU45"}, {"eyeBlink_L", "eyeBlink_R"}},
    {"jaw_open", {"AU27"}, {"jawOpen"}},
};

using Shapes = std::map<std::string, std::map<int, Vector3d>>;

bool read_shapes(const CompareRequest& request, Shapes& shapes) {
  std::ifstream file(request.expressions);
  if (!file) {
    std::fprintf(stderr, "face_fem: error io %s cannot be read\n", request.expressions.c_str());
    return false;
  }
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line[0] == '#' || line.starts_with("expression,")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string name;
    int vertex = -1;
    Vector3d d;
    if (!(words >> name >> vertex >> d.x() >> d.y() >> d.z()) || vertex < 0) {
      std::fprintf(stderr, "face_fem: error syntax %s:%d: expected expression,vertex,dx,dy,dz\n",
                   request.expressions.c_str(), number);
      return false;
    }
    shapes[name][vertex] = request.unit * d;
  }
  return true;
}

// for each `v` line of an OBJ file the vertex of the surface read from it at that place, -1 for none: the reader merges
// equal ones
std::vector<int> surface_vertices(const std::string& path, const Eigen::MatrixX3f& V) {
  std::map<std::array<float, 3>, int> known;
  for (int k = 0; k < int(V.rows()); ++k) known[{V(k, 0), V(k, 1), V(k, 2)}] = k;
  std::vector<int> vertices;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string v;
    std::array<float, 3> p{};
    if (!(words >> v >> p[0] >> p[1] >> p[2]) || v != "v") continue;
    const auto found = known.find(p);
    vertices.push_back(found == known.end() ? -1 : found->second);
  }
  return vertices;
}

struct Motion {
  std::vector<Vector3d> d;  // by place in Actor::vertices()

  double largest() const {
    double most = 0;
    for (const Vector3d& v : d) most = std::max(most, v.norm());
    return most;
  }
};

// where a motion is strongest on the left half, with the mirror image counted in: a mean place, metres
Vector3d peak(const Motion& motion, const std::vector<Vector3d>& places) {
  const double most = motion.largest();
  Vector3d sum(0, 0, 0);
  double weight = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double share = motion.d[k].norm() / most;
    if (share < 0.9) continue;
    sum += share * Vector3d(std::abs(places[k].x()), places[k].y(), places[k].z());
    weight += share;
  }
  return sum / weight;
}

// root mean square distance from the peak, weighted by motion, metres
double extent(const Motion& motion, const std::vector<Vector3d>& places, const Vector3d& from) {
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double m = motion.d[k].squaredNorm();
    sum += m * (Vector3d(std::abs(places[k].x()), places[k].y(), places[k].z()) - from).squaredNorm();
    weight += m;
  }
  return std::sqrt(sum / weight);
}

}  // namespace

int run_compare(const CompareRequest& request) {
  Shapes shapes;
  if (!read_shapes(request, shapes)) return 1;
  auto head = mesh::read_surface(request.head);
  if (!head) {
    std::fprintf(stderr, "face_fem: error %s\n", head.error().sentence.c_str());
    return 1;
  }
  const std::vector<int> vertex_of_line = surface_vertices(request.head, head->V);
  head->V *= float(request.unit);
  FaceOptions options;
  options.columns = request.columns;
  options.rows = request.rows;
  options.layers = request.layers;
  auto built = build_face(*head, options);
  if (!built) {
    std::fprintf(stderr, "face_fem: error %s\n", built.error().sentence.c_str());
    return 1;
  }
  auto made = Actor::make(strengthened(std::move(*built)));
  if (!made) {
    std::fprintf(stderr, "face_fem: error %s\n", made.error().sentence.c_str());
    return 1;
  }
  const Actor& actor = **made;
  (*made)->set_surface(head->V);
  std::vector<std::string> names;
  for (const Muscle& muscle : actor.face().muscles) names.push_back(muscle.name);
  const Driver driver(names);

  std::vector<Vector3d> places;
  for (int v : actor.vertices()) places.push_back(head->V.row(v).transpose().cast<double>());
  const auto nearest = [&](const Vector3d& p) {
    std::size_t best = 0;
    for (std::size_t k = 0; k < places.size(); ++k)
      if ((places[k] - p).norm() < (places[best] - p).norm()) best = k;
    return best;
  };
  const std::size_t corner = nearest(actor.face().landmark("left_mouth_corner").place);

  std::printf("%-15s", "expression");
  for (const char* title : {"cosine", "peak_mm", "truth_mm", "apart_mm", "extent_mm", "truth_mm", "corner_mm",
                            "truth_mm", "cosine", "strain", "frame_ms", "status"})
    std::printf(" %9s", title);
  std::printf("\n");
  for (const Pairing& pairing : pairings) {
    Motion truth, mine;
    truth.d.assign(places.size(), Vector3d::Zero());
    bool known = false;
    for (const std::string& name : pairing.theirs) {
      const auto shape = shapes.find(name);
      if (shape == shapes.end()) continue;
      known = true;
      for (const auto& [line, d] : shape->second) {
        const int vertex = line < int(vertex_of_line.size()) ? vertex_of_line[std::size_t(line)] : -1;
        const auto place = std::lower_bound(actor.vertices().begin(), actor.vertices().end(), vertex);
        if (place != actor.vertices().end() && *place == vertex)
          truth.d[std::size_t(place - actor.vertices().begin())] += d;
      }
    }
    if (!known) continue;
    Levels levels{};
    const auto parts = parse_parts(pairing.ours);
    for (const auto& [place, level] : *parts) levels[std::size_t(place)] = level;
    Habits habits;
    habits.aperture = actor.aperture();
    const Drive drive = driver.drive(levels, {}, habits);
    double milliseconds = 1e9;
    Frame frame;
    for (int run = 0; run < 5; ++run) {
      const double start = cpu_seconds();
      frame = actor.frame(drive, FaceMethod::contact);
      milliseconds = std::min(milliseconds, 1e3 * (cpu_seconds() - start));
    }
    for (std::size_t k = 0; k < places.size(); ++k)
      mine.d.push_back(Eigen::Map<const Eigen::Vector3f>(&frame.displacement[3 * k]).cast<double>());
    double dot = 0, us = 0, them = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      dot += mine.d[k].dot(truth.d[k]);
      us += mine.d[k].squaredNorm();
      them += truth.d[k].squaredNorm();
    }
    const Vector3d my_peak = peak(mine, places), true_peak = peak(truth, places);
    std::printf("%-15s %9.3f %9.2f %9.2f %9.2f %9.1f %9.1f %9.2f %9.2f %9.2f %9.2f %9.3f %9s\n", pairing.name,
                dot / std::sqrt(us * them), 1e3 * mine.largest(), 1e3 * truth.largest(),
                1e3 * (my_peak - true_peak).norm(), 1e3 * extent(mine, places, my_peak),
                1e3 * extent(truth, places, true_peak), 1e3 * mine.d[corner].norm(), 1e3 * truth.d[corner].norm(),
                mine.d[corner].normalized().dot(truth.d[corner].normalized()), frame.validity.strain, milliseconds,
                frame.validity.word());
  }
  std::vector<double> all(std::size_t(actor.muscles()), 0.5);
  Drive drive;
  drive.activation = all;
  double milliseconds = 1e9;
  for (int run = 0; run < 50; ++run) {
    const double start = cpu_seconds();
    if (actor.frame(drive, FaceMethod::basis).displacement.empty()) return 1;
    milliseconds = std::min(milliseconds, 1e3 * (cpu_seconds() - start));
  }
  std::printf("all %d muscles, %zu vertices: basis %.3f ms a frame\n", actor.muscles(), places.size(), milliseconds);
  return 0;
}

}  // namespace face
