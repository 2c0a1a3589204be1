#include "manipulators/mesh/stand_in.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "manipulators/mesh/normals.h"

namespace mesh {
namespace {

using Eigen::Vector3d;

/// A closed surface with rows of vertices around an axis, and a vertex at each end.
/// `point(row, step)`: row in [0, rows), step in [0, around), counter-clockwise seen from the end.
template <class Function>
Surface tube(const std::string& part, int rows, int around, const Vector3d& first, const Vector3d& last,
             Function point) {
  Surface surface;
  surface.part_names = {part};
  surface.V.resize(rows * around + 2, 3);
  for (int row = 0; row < rows; ++row) {
    for (int step = 0; step < around; ++step) {
      surface.V.row(row * around + step) = point(row, step).transpose().template cast<float>();
    }
  }
  surface.V.row(rows * around) = first.transpose().cast<float>();
  surface.V.row(rows * around + 1) = last.transpose().cast<float>();
  surface.F.resize(2 * rows * around, 3);
  int f = 0;
  for (int step = 0; step < around; ++step) {
    const int next = (step + 1) % around;
    const int top = (rows - 1) * around;
    surface.F.row(f++) << rows * around, next, step;
    surface.F.row(f++) << rows * around + 1, top + step, top + next;
    for (int row = 0; row + 1 < rows; ++row) {
      const int a = row * around + step, b = row * around + next;
      surface.F.row(f++) << a, b, b + around;
      surface.F.row(f++) << a, b + around, a + around;
    }
  }
  surface.part.assign(surface.F.rows(), 0);
  surface.N = vertex_normals(surface.V, surface.F);
  return surface;
}

/// A capsule from p to q, in the surface's frame; its radius tapers a little towards q.
Surface capsule(const std::string& part, const Vector3d& p, const Vector3d& q, double radius) {
  constexpr int around = 20;
  constexpr int cap_rows = 5;
  const Vector3d way = q - p;
  const Vector3d z = way.norm() > 1e-9 ? Vector3d(way.normalized()) : Vector3d::UnitY();
  const Vector3d x = z.unitOrthogonal();
  const Vector3d y = z.cross(x);
  const int rows = 2 * cap_rows;
  return tube(part, rows, around, p - radius * z, q + radius * z, [&](int row, int step) {
    const bool lower = row < cap_rows;
    const double latitude =
        lower ? -M_PI / 2 * (cap_rows - 1 - row) / cap_rows : M_PI / 2 * (row - cap_rows) / cap_rows;
    const double longitude = 2 * M_PI * step / around;
    return Vector3d(
        (lower ? p : q) +
        radius * (std::sin(latitude) * z + std::cos(latitude) * (std::cos(longitude) * x + std::sin(longitude) * y)));
  });
}

/// A bump on the head: at direction `at` (unit), raised by `height` as a share of the radius, as wide as `width` (rad)
/// sideways and `tall` up and down.
struct Bump {
  Vector3d at;
  double height, width, tall;
};

double bump(const Bump& b, const Vector3d& direction) {
  const double across = std::atan2(direction.x(), direction.z()) - std::atan2(b.at.x(), b.at.z());
  const double turn = std::remainder(across, 2 * M_PI) / b.width;
  const double rise = (std::asin(std::clamp(direction.y(), -1.0, 1.0)) - std::asin(b.at.y())) / b.tall;
  return b.height * std::exp(-turn * turn - rise * rise);
}

Vector3d look(double side, double up) {
  return {std::sin(side) * std::cos(up), std::sin(up), std::cos(side) * std::cos(up)};
}

/// Radius of the head in a direction, metres, for a head of half height 1 in its own middle: a skull that narrows to
/// the chin, with brow, sockets, nose, cheekbones, lips, chin and the hollow under it.
double head_radius(const Vector3d& d) {
  // an egg: less wide than deep, narrower below
  const double wide = 0.66 + 0.05 * d.y();
  const double deep = 0.80;
  double r = 1 / std::sqrt(d.x() * d.x() / (wide * wide) + d.y() * d.y() + d.z() * d.z() / (deep * deep));
  const double front = std::max(0.0, d.z());
  const Bump features[] = {
      {look(0, 0.26), 0.020, 0.45, 0.10},                                           // brow
      {look(0.30, 0.12), -0.050, 0.15, 0.10},                                       // sockets
      {look(-0.30, 0.12), -0.050, 0.15, 0.10}, {look(0, 0.10), 0.050, 0.07, 0.14},  // bridge of the nose
      {look(0, -0.06), 0.120, 0.09, 0.10},                                          // its tip
      {look(0.12, -0.11), 0.045, 0.06, 0.05},  {look(-0.12, -0.11), 0.045, 0.06, 0.05},
      {look(0.50, -0.06), 0.030, 0.20, 0.16},                                          // cheekbones
      {look(-0.50, -0.06), 0.030, 0.20, 0.16}, {look(0, -0.25), -0.030, 0.30, 0.035},  // under the nose
      {look(0, -0.345), 0.038, 0.22, 0.045},                                           // upper lip
      {look(0, -0.405), -0.020, 0.24, 0.020},                                          // mouth
      {look(0, -0.465), 0.042, 0.20, 0.045},                                           // lower lip
      {look(0, -0.56), -0.020, 0.25, 0.040},   {look(0, -0.70), 0.075, 0.26, 0.13},    // chin
  };
  double relief = 0;
  for (const Bump& feature : features) {
    relief += bump(feature, d);
  }
  r *= 1 + front * relief;
  // the jaw ends forward; below and behind it the head goes over into the neck
  r *= 1 - 0.22 * std::max(0.0, -d.y()) * std::max(0.0, 0.35 - d.z());
  // ears
  for (double side : {M_PI / 2 - 0.1, -M_PI / 2 + 0.1}) {
    r *= 1 + bump({look(side, 0.02), 0.16, 0.07, 0.22}, d);
  }
  return r;
}

/// The modelled head: rows from chin to crown around the vertical, in the surface's frame.
Surface head(const Bone& bone) {
  constexpr int rows = 96;
  constexpr int around = 128;
  // bone.radius is about half the width of the head; its axis stands in the skull
  const double half_height = bone.radius / 0.66;
  const Vector3d middle = bone.from + Vector3d(0, 0.1 * half_height, 0.15 * half_height);
  const auto at = [&](double latitude, double longitude) -> Vector3d {
    const Vector3d d = look(longitude, latitude);
    return bone.bind * Vector3d(middle + half_height * head_radius(d) * d);
  };
  Surface surface = tube("skin", rows, around, at(-M_PI / 2, 0), at(M_PI / 2, 0), [&](int row, int step) {
    const double latitude = -M_PI / 2 + M_PI * (row + 0.5) / rows;
    return at(latitude, 2 * M_PI * step / around);
  });
  return surface;
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

}  // namespace

Skin stand_in(const std::vector<Bone>& bones) {
  Skin skin;
  skin.bones = bones;
  skin.surface.N.resize(0, 3);
  std::vector<int> owner;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Bone& bone = bones[b];
    const bool is_head = ends_with(bone.name, "head");
    // the jaw is part of the modelled head
    if (ends_with(bone.name, "jaw")) {
      continue;
    }
    const Surface piece =
        is_head ? head(bone) : capsule("skin", bone.bind * bone.from, bone.bind * bone.to, 0.85 * bone.radius);
    append(skin.surface, piece);
    owner.resize(skin.surface.V.rows(), static_cast<int>(b));
  }
  skin.index = Skin::Indices::Zero(owner.size(), Skin::influences);
  skin.weight = Skin::Weights::Zero(owner.size(), Skin::influences);
  for (std::size_t v = 0; v < owner.size(); ++v) {
    skin.index(v, 0) = owner[v];
    skin.weight(v, 0) = 1;
  }
  skin.weld = welded(skin.surface.V);
  skin.surface.N = vertex_normals(skin.surface.V, skin.surface.F);
  return skin;
}

}  // namespace mesh
