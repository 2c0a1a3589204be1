#include "manipulators/mesh/figure/uniform.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manipulators/mesh/figure/section.h"
#include "manipulators/mesh/normals.h"

namespace figure {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;
using Bones = std::vector<std::string>;

/// The dress is cut for a body of this stature; all its lengths go with the stature.
constexpr double cut_for = 1.66;

const Vector3d white(0.96, 0.96, 0.94);
const Vector3d navy(0.16, 0.19, 0.30);
const Vector3d blue(0.20, 0.32, 0.60);
const Vector3d black(0.11, 0.11, 0.12);
const Vector3d leather(0.10, 0.095, 0.095);
const Vector3d hair(0.24, 0.18, 0.14);
const Vector3d brow(0.30, 0.22, 0.17);
const Vector3d lash(0.13, 0.09, 0.07);
const Vector3d lip(0.72, 0.44, 0.41);

/// Draws up garments in metres of a body as tall as `cut_for`, then scales them.
class Tailor {
 public:
  explicit Tailor(double scale) : scale_(scale) {}

  Clothing& add(const std::string& name, int layer, const Vector3d& color, const Bones& bones) {
    clothing_.emplace_back();
    Clothing& piece = clothing_.back();
    piece.name = name;
    piece.layer = layer;
    piece.color = color;
    piece.bones = bones;
    return piece;
  }

  std::vector<Clothing> finished() {
    for (Clothing& piece : clothing_) {
      piece.planes.col(3) *= scale_;
      piece.lines *= scale_;
      piece.thickness *= scale_;
      piece.flare[3] *= scale_;
    }
    std::stable_sort(clothing_.begin(), clothing_.end(), [](const Clothing& a, const Clothing& b) {
      return std::pair(a.layer, a.name) < std::pair(b.layer, b.name);
    });
    return clothing_;
  }

 private:
  double scale_;
  std::vector<Clothing> clothing_;
};

void inside(Clothing& piece, const Vector4d& plane) {
  piece.planes.conservativeResize(piece.planes.rows() + 1, 4);
  piece.planes.bottomRows(1) = plane.transpose();
}
void above(Clothing& piece, double y) { inside(piece, {0, 1, 0, -y}); }
void below(Clothing& piece, double y) { inside(piece, {0, -1, 0, y}); }
/// Between two values of n . p.
void slab(Clothing& piece, const Vector3d& n, double low, double high) {
  inside(piece, {n.x(), n.y(), n.z(), -low});
  inside(piece, {-n.x(), -n.y(), -n.z(), high});
}
/// A line of balls; mirrored to the other side when asked.
void line(Clothing& piece, const std::vector<Vector4d>& balls, bool mirror = false) {
  for (const Vector4d& ball : balls) {
    piece.lines.conservativeResize(piece.lines.rows() + 1, 4);
    piece.lines.bottomRows(1) << (mirror ? -ball.x() : ball.x()), ball.y(), ball.z(), ball.w();
  }
  piece.lines.conservativeResize(piece.lines.rows() + 1, 4);
  piece.lines.bottomRows(1).setZero();
}

const Bones trunk = {"pelvis",    "lumbar_lower",  "lumbar_upper",   "thorax_lower", "thorax_upper", "neck_c7_t1",
                     "neck_c6_7", "left_clavicle", "right_clavicle", "left_scapula", "right_scapula"};

Bones both_sides(const Bones& names) {
  Bones result;
  for (const char* side : {"left_", "right_"}) {
    for (const std::string& name : names) {
      result.push_back(side + name);
    }
  }
  return result;
}

Bones joined(Bones a, const Bones& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The slanting plane in which blouse and collar end at the neck: higher behind than in front.
const Vector4d neckline(0, -1, -0.4, 1.398);

/// The opening in front is a V with its point on the breast; its borders have this slope.
constexpr double v_point = 1.245;
constexpr double v_slope = 0.33;
/// The collar lies along the V and widens to the shoulder with this slope.
constexpr double lapel_point = 1.222;
constexpr double lapel_slope = 0.82;

void opening(Clothing& piece) {
  inside(piece, {-1, v_slope, 0, -v_slope * v_point});
  inside(piece, {1, v_slope, 0, -v_slope * v_point});
  inside(piece, neckline);
  inside(piece, {0, 0, 1, -0.02});
}

void face(Tailor& tailor) {
  // above the ears, and behind them down to the nape
  const auto scalp = [&](const std::string& name) -> Clothing& {
    Clothing& piece = tailor.add(name, 1, hair,
                                 {"head", "jaw", "right_jaw", "left_jaw", "front_jaw", "right_upper_jaw",
                                  "left_upper_jaw", "front_upper_jaw", "neck_c1_2", "neck_c2_3", "neck_c3_4"});
    slab(piece, Vector3d::UnitX(), -0.0722, 0.0722);
    piece.thickness = 0.0035;
    piece.smoothing = 8;
    piece.gloss = 0.25;
    return piece;
  };
  Clothing& crown = scalp("hair");
  above(crown, 1.562);
  inside(crown, {0, 0.60, -0.80, -0.60 * 1.625 + 0.80 * 0.112});
  Clothing& nape = scalp("hair_nape");
  slab(nape, Vector3d::UnitY(), 1.492, 1.562);
  inside(nape, {0, 0, -1, 0.014});

  Clothing& brows = tailor.add("brows", 2, brow, {});
  for (bool mirror : {false, true}) {
    line(brows,
         {{0.0125, 1.5685, 0.1428, 0.0022},
          {0.0180, 1.5705, 0.1425, 0.0027},
          {0.0260, 1.5728, 0.1412, 0.0025},
          {0.0340, 1.5738, 0.1380, 0.0020},
          {0.0400, 1.5725, 0.1345, 0.0014},
          {0.0455, 1.5695, 0.1300, 0.0010}},
         mirror);
  }
  brows.thickness = 0.0006;

  // along the edge of the upper lid
  Clothing& lashes = tailor.add("lashes", 2, lash, {});
  for (bool mirror : {false, true}) {
    line(lashes,
         {{0.0223, 1.5547, 0.1316, 0.0007},
          {0.0256, 1.5560, 0.1323, 0.0009},
          {0.0293, 1.5566, 0.1325, 0.0010},
          {0.0330, 1.5567, 0.1317, 0.0010},
          {0.0360, 1.5560, 0.1307, 0.0010},
          {0.0382, 1.5552, 0.1289, 0.0010},
          {0.0405, 1.5539, 0.1268, 0.0009},
          {0.0420, 1.5531, 0.1252, 0.0006}},
         mirror);
  }

  Clothing& lips = tailor.add("lips", 2, lip, {});
  for (bool mirror : {false, true}) {
    line(lips,
         {{0.0230, 1.4875, 0.1395, 0.0012},
          {0.0120, 1.4915, 0.1480, 0.0036},
          {0.0040, 1.4935, 0.1525, 0.0042},
          {0.0, 1.4920, 0.1525, 0.0036}},
         mirror);
    line(lips, {{0.0200, 1.4872, 0.1405, 0.0015}, {0.0, 1.4868, 0.1473, 0.0030}}, mirror);
    line(lips, {{0.0230, 1.4870, 0.1395, 0.0012}, {0.0120, 1.4815, 0.1460, 0.0042}, {0.0, 1.4800, 0.1490, 0.0056}},
         mirror);
  }
  lips.gloss = 0.35;
}

void trousers(Tailor& tailor) {
  Clothing& piece = tailor.add(
      "trousers", 3, navy,
      joined({"pelvis", "lumbar_lower", "lumbar_upper"}, both_sides({"thigh_1", "thigh_2", "shin", "foot", "heel"})));
  // up to the hem of the blouse
  below(piece, 0.925);
  above(piece, 0.080);
  piece.thickness = 0.013;
  // bell-bottoms: wider from the knee down
  piece.flare = {0, -0.085, 0, 0.085 * 0.52};
  piece.smoothing = 16;

  // inside the shoes
  Clothing& socks = tailor.add("socks", 2, leather, both_sides({"shin", "foot", "heel", "toes", "big_toe"}));
  below(socks, 0.10);
}

void blouse(Tailor& tailor, const Vector3d& elbow, const Vector3d& wrist) {
  Clothing& piece = tailor.add("blouse", 4, white,
                               joined(trunk, both_sides({"humerus_1", "humerus_2", "humerus_3", "ulna", "forearm_1",
                                                         "forearm_2", "forearm_3", "hand", "thigh_1"})));
  above(piece, 0.925);
  inside(piece, neckline);
  const Vector3d back = (elbow - wrist).normalized();
  for (double side : {-1.0, 1.0}) {
    const Vector3d n(side * back.x(), back.y(), back.z());
    const Vector3d end(side * wrist.x(), wrist.y(), wrist.z());
    inside(piece, {n.x(), n.y(), n.z(), -n.dot(end)});
  }
  piece.thickness = 0.014;
  // it hangs from the chest, not from the waist
  piece.flare = {0, -0.07, 0, 0.07 * 1.12};
  piece.smoothing = 80;

  Clothing& shirt = tailor.add("shirt", 5, white, {});
  opening(shirt);
  shirt.thickness = 0.004;
  shirt.smoothing = 2;
  for (int stripe = 0; stripe < 5; ++stripe) {
    Clothing& blue_stripe = tailor.add("shirt_stripe_" + std::to_string(stripe + 1), 6, blue, {});
    opening(blue_stripe);
    const double low = 1.268 + 0.024 * stripe;
    slab(blue_stripe, Vector3d(0, 1, 0.25).normalized(), low, low + 0.011);
    blue_stripe.thickness = 0.004;
    blue_stripe.smoothing = 2;
  }

  for (double side : {-1.0, 1.0}) {
    const std::string name = side < 0 ? "right_" : "left_";
    const Vector3d n(side * back.x(), back.y(), back.z());
    const double end = n.dot(Vector3d(side * wrist.x(), wrist.y(), wrist.z()));
    const Bones arm = {name + "forearm_1", name + "forearm_2", name + "forearm_3", name + "hand"};
    Clothing& cuff = tailor.add(name + "cuff", 6, blue, arm);
    slab(cuff, n, end - 0.001, end + 0.046);
    cuff.thickness = 0.017;
    cuff.smoothing = 4;
    Clothing& trim = tailor.add(name + "cuff_trim", 7, white, arm);
    slab(trim, n, end + 0.030, end + 0.035);
    trim.thickness = 0.017;
    trim.smoothing = 4;
  }
}

void collar(Tailor& tailor) {
  const auto lapel = [](Clothing& piece, double side, double from_edge, double to_edge) {
    // outside the V, inside the outer border; the distances are taken from that border
    inside(piece, {side, -v_slope, 0, v_slope * v_point});
    const Vector3d n = Vector3d(-side, lapel_slope, 0);
    slab(piece, n, lapel_slope * lapel_point + from_edge * n.norm(), lapel_slope * lapel_point + to_edge * n.norm());
    inside(piece, neckline);
    inside(piece, {0, 0, 1, 0.021});
    // the other lapel has the other side
    inside(piece, {side, 0, 0, 0});
    piece.thickness = 0.018;
    piece.smoothing = 12;
  };
  const auto back = [](Clothing& piece) {
    inside(piece, {0, 0, -1, -0.020});
    inside(piece, neckline);
    piece.thickness = 0.018;
    piece.smoothing = 12;
  };
  for (double side : {-1.0, 1.0}) {
    const std::string name = side < 0 ? "right_" : "left_";
    lapel(tailor.add(name + "lapel", 7, blue, trunk), side, 0, 1);
    lapel(tailor.add(name + "lapel_trim", 8, white, trunk), side, 0.010, 0.015);
    Clothing& trim = tailor.add(name + "collar_trim", 8, white, trunk);
    back(trim);
    slab(trim, side * Vector3d::UnitX(), 0.115, 0.120);
    above(trim, 1.224);
  }
  Clothing& flap = tailor.add("collar", 7, blue, trunk);
  back(flap);
  slab(flap, Vector3d::UnitX(), -0.136, 0.136);
  above(flap, 1.209);
  Clothing& hem = tailor.add("collar_hem", 8, white, trunk);
  back(hem);
  slab(hem, Vector3d::UnitX(), -0.120, 0.120);
  slab(hem, Vector3d::UnitY(), 1.224, 1.229);

  Clothing& knot = tailor.add("neckerchief", 9, black, trunk);
  slab(knot, Vector3d::UnitX(), -0.017, 0.017);
  slab(knot, Vector3d::UnitY(), 1.214, 1.250);
  inside(knot, {0, 0, 1, -0.03});
  knot.thickness = 0.026;
  knot.smoothing = 3;
  for (double side : {-1.0, 1.0}) {
    Clothing& tail = tailor.add(side < 0 ? "right_tail" : "left_tail", 9, black, trunk);
    const Vector3d across = Vector3d(side, 0.16, 0).normalized();
    slab(tail, across, across.dot(Vector3d(side * 0.001, 1.22, 0)), across.dot(Vector3d(side * 0.026, 1.22, 0)));
    slab(tail, Vector3d::UnitY(), 1.10, 1.214);
    inside(tail, {0, 0, 1, -0.03});
    tail.thickness = 0.019;
    tail.smoothing = 12;
  }
}

/// A point of the cap's outline: radius as a factor on the head's, height.
struct Ring {
  double factor, y;
};

}  // namespace

std::vector<Clothing> uniform(const Landmarks& marks) {
  const double scale = marks.stature / cut_for;
  Tailor tailor(scale);
  face(tailor);
  trousers(tailor);
  blouse(tailor, marks.elbow / scale, marks.wrist / scale);
  collar(tailor);
  return tailor.finished();
}

std::vector<mesh::Garment> garments(const std::vector<Clothing>& clothing, const std::vector<mesh::Bone>& bones) {
  std::vector<mesh::Garment> result;
  for (const Clothing& piece : clothing) {
    mesh::Garment garment;
    garment.name = piece.name;
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (std::find(piece.bones.begin(), piece.bones.end(), bones[b].name) != piece.bones.end()) {
        garment.bones.push_back(static_cast<int>(b));
      }
    }
    garment.planes = piece.planes;
    garment.lines = piece.lines;
    garment.thickness = piece.thickness;
    garment.flare = piece.flare;
    garment.smoothing = piece.smoothing;
    result.push_back(garment);
  }
  return result;
}

double sole(const Landmarks& marks) { return 0.014 * marks.stature / cut_for; }

mesh::Surface mirror_image(mesh::Surface surface) {
  surface.V.col(0) *= -1;
  if (surface.N.rows() > 0) {
    surface.N.col(0) *= -1;
  }
  surface.F.col(1).swap(surface.F.col(2));
  return surface;
}

namespace {

/// How far the points reach in direction (cos, sin) from `centre`: the hull's support, seen from inside.
double reach(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& centre, double angle) {
  // the hull's border in this direction lies where the narrowest supporting line cuts it
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
  for (int step = -8; step <= 8; ++step) {
    const double turned = angle + step * M_PI / 18;
    const Eigen::Vector2d n(std::cos(turned), std::sin(turned));
    double support = 0;
    for (const Eigen::Vector2d& p : points) {
      support = std::max(support, n.dot(p - centre));
    }
    least = std::min(least, support / n.dot(way));
  }
  return least;
}

}  // namespace

mesh::Surface shoe(const mesh::Surface& body, const Landmarks& marks) {
  const double scale = marks.stature / cut_for;
  constexpr int around = 32;
  constexpr int slices = 28;
  const double leather_thickness = 0.005 * scale;
  const double top = 0.088 * scale;
  const double heel = marks.heel.z() - leather_thickness;
  const double toe = marks.toe.z() + 2 * leather_thickness;

  mesh::Surface surface;
  surface.part_names = {"shoe"};
  // outline of each slice: where its middle is and how far the hull of the foot reaches around it
  Eigen::MatrixX2d centre(slices, 2);
  Eigen::MatrixXd radius(slices, around);
  std::vector<double> z(slices);
  for (int slice = 0; slice < slices; ++slice) {
    // slices crowd at the ends, where the outline is round
    z[slice] = heel + (0.5 - 0.5 * std::cos(M_PI * (slice + 0.5) / slices)) * (toe - heel);
    std::vector<Eigen::Vector2d> points;
    for (double near : {-0.006, 0.0, 0.006}) {
      const double plane = std::clamp(z[slice] + near, marks.heel.z() + 0.001, marks.toe.z() - 0.001);
      for (const Loop& loop : section(body, {0, 0, plane}, Vector3d::UnitZ())) {
        for (const Vector3d& p : loop.points) {
          if (p.x() > 0 && p.y() < top) {
            points.emplace_back(p.x(), p.y());
          }
        }
      }
    }
    Eigen::Vector2d low = points.front(), high = points.front();
    for (const Eigen::Vector2d& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    centre.row(slice) = 0.5 * (low + high).transpose();
    for (int step = 0; step < around; ++step) {
      radius(slice, step) = reach(points, centre.row(slice).transpose(), 2 * M_PI * step / around);
    }
  }
  // leather bridges the gaps between toes
  for (int pass = 0; pass < 3; ++pass) {
    const Eigen::MatrixXd r = radius;
    const Eigen::MatrixX2d c = centre;
    for (int slice = 1; slice + 1 < slices; ++slice) {
      radius.row(slice) = 0.25 * r.row(slice - 1) + 0.5 * r.row(slice) + 0.25 * r.row(slice + 1);
      centre.row(slice) = 0.25 * c.row(slice - 1) + 0.5 * c.row(slice) + 0.25 * c.row(slice + 1);
    }
  }
  std::vector<Vector3d> vertices;
  for (int slice = 0; slice < slices; ++slice) {
    // both ends close round
    const double end = std::clamp(std::min(z[slice] - heel, toe - z[slice]) / (0.022 * scale), 0.0, 1.0);
    const double roundness = std::sqrt(1 - (1 - end) * (1 - end));
    for (int step = 0; step < around; ++step) {
      const double angle = 2 * M_PI * step / around;
      const double r = radius(slice, step) * roundness + leather_thickness;
      Vector3d p(centre(slice, 0) + r * std::cos(angle), centre(slice, 1) + r * std::sin(angle), z[slice]);
      p.y() = p.y() < 0.012 * scale ? -sole(marks) : p.y();
      vertices.push_back(p);
    }
  }
  // the last two vertices close heel and toe
  const auto middle = [&](int slice) {
    Vector3d sum = Vector3d::Zero();
    for (int step = 0; step < around; ++step) {
      sum += vertices[slice * around + step] / around;
    }
    return sum;
  };
  vertices.push_back(middle(0));
  vertices.push_back(middle(slices - 1));
  std::vector<Eigen::RowVector3i> faces;
  for (int step = 0; step < around; ++step) {
    const int next = (step + 1) % around;
    const int last = (slices - 1) * around;
    faces.emplace_back(slices * around, next, step);
    faces.emplace_back(slices * around + 1, last + step, last + next);
    for (int slice = 0; slice + 1 < slices; ++slice) {
      const int a = slice * around + step, b = slice * around + next;
      faces.emplace_back(a, b, b + around);
      faces.emplace_back(a, b + around, a + around);
    }
  }
  surface.V.resize(vertices.size(), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    surface.V.row(v) = (vertices[v] - marks.ball).cast<float>();
  }
  surface.F.resize(faces.size(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    surface.F.row(f) = faces[f];
  }
  surface.part.assign(faces.size(), 0);
  surface.N = mesh::vertex_normals(surface.V, surface.F);
  return surface;
}

mesh::Surface cap(const Landmarks& marks) {
  const double scale = marks.stature / cut_for;
  // from inside the crown over its top, down to the band, out and up the turned-up brim, over its edge and down inside
  const std::vector<Ring> outline = {{0.0, 0.098},   {0.35, 0.096},  {0.62, 0.090},  {0.82, 0.078},  {0.93, 0.060},
                                     {0.965, 0.040}, {0.985, 0.016}, {1.04, 0.013},  {1.075, 0.020}, {1.115, 0.044},
                                     {1.135, 0.062}, {1.155, 0.066}, {1.175, 0.062}, {1.165, 0.046}, {1.12, 0.014},
                                     {1.06, 0.0},    {0.98, 0.0},    {0.95, 0.006},  {0.93, 0.030},  {0.88, 0.056},
                                     {0.76, 0.074},  {0.55, 0.086},  {0.30, 0.092},  {0.0, 0.094}};
  constexpr int around = 48;
  // the head at the height of the band, hair included: half width and half depth, and its centre
  const Eigen::Vector2d half(0.0765, 0.1015);
  const Vector3d centre(0, 1.600, 0.0465);
  const double tilt = -0.14;

  mesh::Surface surface;
  surface.part_names = {"cap"};
  const int rings = static_cast<int>(outline.size());
  surface.V.resize((rings - 2) * around + 2, 3);
  const auto place = [&](int row, double x, double y, double z) {
    const Vector3d p(x, std::cos(tilt) * y - std::sin(tilt) * z, std::sin(tilt) * y + std::cos(tilt) * z);
    surface.V.row(row) = (scale * (p + centre) - marks.skull).cast<float>();
  };
  place(0, 0, outline.front().y, 0);
  place(1, 0, outline.back().y, 0);
  const auto vertex = [&](int ring, int step) {
    return ring == 0 ? 0 : ring == rings - 1 ? 1 : 2 + (ring - 1) * around + step % around;
  };
  for (int ring = 1; ring < rings - 1; ++ring) {
    for (int step = 0; step < around; ++step) {
      const double angle = 2 * M_PI * step / around;
      place(vertex(ring, step), outline[ring].factor * half.x() * std::sin(angle), outline[ring].y,
            outline[ring].factor * half.y() * std::cos(angle));
    }
  }
  std::vector<Eigen::RowVector3i> faces;
  for (int ring = 0; ring + 1 < rings; ++ring) {
    for (int step = 0; step < around; ++step) {
      const int a = vertex(ring, step), b = vertex(ring, step + 1);
      const int c = vertex(ring + 1, step), d = vertex(ring + 1, step + 1);
      if (ring > 0) {
        faces.emplace_back(a, d, b);
      }
      if (ring + 2 < rings) {
        faces.emplace_back(a, c, d);
      } else {
        faces.back() = {a, c, b};
      }
    }
  }
  surface.F.resize(faces.size(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    surface.F.row(f) = faces[f];
  }
  surface.part.assign(faces.size(), 0);
  surface.N = mesh::vertex_normals(surface.V, surface.F);
  return surface;
}

}  // namespace figure
