#pragma once

#include <cmath>

namespace eye {

inline constexpr double pi = 3.14159265358979323846;
/// one degree, rad
inline constexpr double deg = pi / 180;

/// A pair of angles (or their rates): x to the person's own right, y up; rad, rad/s.
struct Vec2 {
  double x = 0, y = 0;

  Vec2& operator+=(Vec2 o) { return x += o.x, y += o.y, *this; }
  Vec2& operator-=(Vec2 o) { return x -= o.x, y -= o.y, *this; }
  bool operator==(const Vec2&) const = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
inline double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
inline double norm(Vec2 a) { return std::sqrt(dot(a, a)); }

}  // namespace eye
