#pragma once

#include <memory>
#include <vector>

#include "manipulators/render/scene.h"

/// Bodies made by formula. All closed surfaces wind counter-clockwise seen from outside. Metres.
namespace render {

/// A sphere of radius 1 about the origin, poles on Z (so that an iris on +Z is evenly meshed); four levels of detail.
GeometryPointer unit_sphere();
/// A cube of side 1 about the origin.
GeometryPointer unit_box();
/// Radius 1, length 1 along y, centred at the origin, closed ends.
GeometryPointer unit_cylinder();
/// Radius 1 at y = 0, apex at y = 1, closed base.
GeometryPointer unit_cone();
/// A cylinder of `length` along y with half spheres of `radius` added at both ends.
GeometryPointer capsule(float radius, float length);
/// A cap of a hollow sphere of radius 1: the points with polar angle below `half_angle` around +Z.
GeometryPointer sphere_cap(float half_angle);
/// The open surface of a cone with its apex at the origin, opening around +Z: slant 1, half angle at azimuth k given
/// by `half_angles[k]` (evenly spaced from +X toward +Y). Draws a joint's limits.
GeometryPointer limit_cone(const std::vector<float>& half_angles);
/// A sector of a disc of radius 1 in the plane z = 0 from angle `from` to `to` [rad, from +X toward +Y], both sides.
GeometryPointer sector(float from, float to);
/// A round tube through `points` whose radius at each is `radii` and colour `colors` (empty: white); ends closed.
GeometryPointer tube(const std::vector<Eigen::Vector3f>& points, const std::vector<float>& radii,
                     const std::vector<std::array<std::uint8_t, 4>>& colors, int sides = 10);
/// Line segments point[0]-point[1], point[2]-point[3] ...; one colour a point (empty: white).
GeometryPointer segments(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<std::array<std::uint8_t, 4>>& colors = {});

/// Normals of a triangle list: area-weighted means at each vertex; isolated vertices keep +Y.
void recompute_normals(Geometry& geometry);

/// A colour for `x` in 0..1: dark blue, teal, yellow, red; even steps in x look even. NaN gives grey.
std::array<std::uint8_t, 4> heat(double x);

/// Adds up to four coarser levels by edge collapse (meshoptimizer), each as coarse as its error allows: 0.03, 0.12,
/// 0.35 and 1.2 % of the largest extent. The levels share the vertices, so a surface that deforms keeps them.
void add_levels(Geometry& geometry);

}  // namespace render
