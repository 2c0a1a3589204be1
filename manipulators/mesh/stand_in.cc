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

/// A capsule from p to q with a radius at each, in the surface's frame. Thick ones, the trunk's, end flat: their
/// neighbours go on from there.
Surface capsule(const std::string& part, const Vector3d& p, const Vector3d& q, double radius_p, double radius_q) {
  constexpr int around = 24;
  constexpr int cap_rows = 6;
  constexpr double limb = 0.06;
  const auto height = [](double radius) { return radius > limb ? limb * limb / radius : radius; };
  const Vector3d way = q - p;
  const Vector3d z = way.norm() > 1e-9 ? Vector3d(way.normalized()) : Vector3d::UnitY();
  const Vector3d x = z.unitOrthogonal();
  const Vector3d y = z.cross(x);
  return tube(part, 2 * cap_rows, around, p - height(radius_p) * z, q + height(radius_q) * z, [&](int row, int step) {
    const bool lower = row < cap_rows;
    const double latitude =
        lower ? -M_PI / 2 * (cap_rows - 1 - row) / cap_rows : M_PI / 2 * (row - cap_rows) / cap_rows;
    const double longitude = 2 * M_PI * step / around;
    const Vector3d across = std::cos(longitude) * x + std::sin(longitude) * y;
    const double radius = lower ? radius_p : radius_q;
    return Vector3d((lower ? p : q) + height(radius) * std::sin(latitude) * z + radius * std::cos(latitude) * across);
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

/// Radius of the head in a direction from the middle between crown and chin, for a head of half height 1: a skull that
/// narrows to the jaw, with brow, sockets, nose, cheekbones, lips, chin and ears. Directions of the features as they
/// lie on a face whose eyes are at half height and whose mouth is a third of the way from there to the chin.
double head_radius(const Vector3d& d) {
  const double wide = 0.66 + 0.06 * d.y();
  const double deep = 0.86;
  double r = 1 / std::sqrt(d.x() * d.x() / (wide * wide) + d.y() * d.y() + d.z() * d.z() / (deep * deep));
  const Bump features[] = {
      {look(0, -0.62), 0.150, 0.50, 0.34},      // jaw
      {look(0, 0.19), 0.030, 0.50, 0.09},       // brow
      {look(0.315, 0.01), -0.055, 0.14, 0.09},  // sockets
      {look(-0.315, 0.01), -0.055, 0.14, 0.09},
      {look(0, -0.02), 0.040, 0.08, 0.16},  // bridge of the nose
      {look(0, -0.25), 0.150, 0.10, 0.09},  // its tip
      {look(0.13, -0.31), 0.050, 0.07, 0.05},
      {look(-0.13, -0.31), 0.050, 0.07, 0.05},
      {look(0.55, -0.20), 0.040, 0.20, 0.15},  // cheekbones
      {look(-0.55, -0.20), 0.040, 0.20, 0.15},
      {look(0, -0.42), -0.020, 0.12, 0.040},   // under the nose
      {look(0, -0.505), 0.030, 0.20, 0.040},   // upper lip
      {look(0, -0.560), -0.025, 0.22, 0.014},  // mouth
      {look(0, -0.615), 0.032, 0.18, 0.040},   // lower lip
      {look(0, -0.72), -0.030, 0.25, 0.045},
      {look(0, -0.86), 0.060, 0.24, 0.11},               // chin
      {look(M_PI / 2 + 0.15, -0.12), 0.15, 0.09, 0.20},  // ears
      {look(-M_PI / 2 - 0.15, -0.12), 0.15, 0.09, 0.20},
  };
  double relief = 0;
  for (const Bump& feature : features) {
    relief += bump(feature, d);
  }
  return r * (1 + relief);
}

/// The modelled head: rows from chin to crown around the vertical, in the surface's frame.
Surface head(const Bone& bone) {
  constexpr int rows = 112;
  constexpr int around = 144;
  // the bone's radius is the mean of half width and half depth; its axis begins in the middle of the head
  const double half_height = 1.265 * bone.radius;
  const auto at = [&](double latitude, double longitude) -> Vector3d {
    const Vector3d d = look(longitude, latitude);
    return bone.bind * Vector3d(bone.from + half_height * head_radius(d) * d);
  };
  return tube("skin", rows, around, at(-M_PI / 2, 0), at(M_PI / 2, 0),
              [&](int row, int step) { return at(-M_PI / 2 + M_PI * (row + 0.5) / rows, 2 * M_PI * step / around); });
}

/// How thick a bone ends: as the one that goes on from there begins, the trunk a little wider than the neck.
double end_radius(const std::vector<Bone>& bones, const Bone& bone) {
  constexpr double near = 0.02;
  double radius = bone.radius;
  for (const Bone& next : bones) {
    if (&next != &bone && (next.bind * next.from - bone.bind * bone.to).norm() < near) {
      radius = std::min(radius, bone.radius > 0.1 ? 1.4 * next.radius : next.radius);
    }
  }
  return radius;
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
  // skin is about as far from the axis as the radius says; capsules in full would stand out where they meet
  constexpr double fullness = 0.85;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Bone& bone = bones[b];
    const bool is_head = ends_with(bone.name, "head");
    // the jaw is part of the modelled head
    if (ends_with(bone.name, "jaw")) {
      continue;
    }
    const Surface piece = is_head ? head(bone)
                                  : capsule("skin", bone.bind * bone.from, bone.bind * bone.to, fullness * bone.radius,
                                            fullness * end_radius(bones, bone));
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
  // made of no file's vertices
  skin.origin.first.assign(static_cast<std::size_t>(skin.surface.V.rows()) + 1, 0);
  skin.surface.N = vertex_normals(skin.surface.V, skin.surface.F);
  return skin;
}

}  // namespace mesh
