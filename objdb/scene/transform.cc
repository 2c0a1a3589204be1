#include "objdb/scene/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace objdb::scene {

namespace {

// R p + t; where that is beyond a double, the largest double: no infinity ever enters the world
Vec3 carry(const Transform& x, const Vec3& point) {
  Vec3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = x.R[i][0] * point[0] + x.R[i][1] * point[1] + x.R[i][2] * point[2] + x.p[i];
    if (!std::isfinite(out[i])) {
      // the wider exponent of long double keeps the sum finite, and its sign right
      long double sum = x.p[i];
      for (std::size_t j = 0; j < 3; ++j) sum += static_cast<long double>(x.R[i][j]) * point[j];
      constexpr long double most = std::numeric_limits<double>::max();
      out[i] = static_cast<double>(std::clamp(sum, -most, most));
    }
  }
  return out;
}

}  // namespace

Transform operator*(const Transform& a, const Transform& b) {
  Transform out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out.R[i][j] = a.R[i][0] * b.R[0][j] + a.R[i][1] * b.R[1][j] + a.R[i][2] * b.R[2][j];
  out.p = carry(a, b.p);
  return out;
}

Vec3 operator*(const Transform& x, const Vec3& point) { return carry(x, point); }

Transform inverse(const Transform& x) {
  Transform out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out.R[i][j] = x.R[j][i];
  out.p = carry(out, {-x.p[0], -x.p[1], -x.p[2]});
  return out;
}

Transform from_pose(const Vec3& position, const Quat& orientation) {
  Quat q = orientation;
  double length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(length > 1e-290 && length < 1e300)) {
    // at the ends of the number range the length overflows or has few bits left: scale first, exactly
    int exponent = 0;
    std::frexp(std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2]), std::abs(q[3])}), &exponent);
    for (double& each : q) each = std::ldexp(each, -exponent);
    length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  }
  const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
  Transform out;
  out.R = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  out.p = position;
  return out;
}

Quat quaternion(const Transform& t) {
  const auto& R = t.R;
  const double trace = R[0][0] + R[1][1] + R[2][2];
  Quat q;
  // the largest of w x y z is taken from the diagonal, the others by division through it
  if (trace >= R[0][0] && trace >= R[1][1] && trace >= R[2][2]) {
    const double s = std::sqrt(1 + trace) * 2;
    q = {s / 4, (R[2][1] - R[1][2]) / s, (R[0][2] - R[2][0]) / s, (R[1][0] - R[0][1]) / s};
  } else if (R[0][0] >= R[1][1] && R[0][0] >= R[2][2]) {
    const double s = std::sqrt(1 + R[0][0] - R[1][1] - R[2][2]) * 2;
    q = {(R[2][1] - R[1][2]) / s, s / 4, (R[0][1] + R[1][0]) / s, (R[0][2] + R[2][0]) / s};
  } else if (R[1][1] >= R[2][2]) {
    const double s = std::sqrt(1 - R[0][0] + R[1][1] - R[2][2]) * 2;
    q = {(R[0][2] - R[2][0]) / s, (R[0][1] + R[1][0]) / s, s / 4, (R[1][2] + R[2][1]) / s};
  } else {
    const double s = std::sqrt(1 - R[0][0] - R[1][1] + R[2][2]) * 2;
    q = {(R[1][0] - R[0][1]) / s, (R[0][2] + R[2][0]) / s, (R[1][2] + R[2][1]) / s, s / 4};
  }
  if (q[0] < 0)
    for (double& each : q) each = -each;
  return q;
}

Transform denavit_hartenberg(double theta, double d, double a, double alpha) {
  const double ct = std::cos(theta), st = std::sin(theta), ca = std::cos(alpha), sa = std::sin(alpha);
  Transform out;
  out.R = {{{ct, -st * ca, st * sa}, {st, ct * ca, -ct * sa}, {0, sa, ca}}};
  out.p = {a * ct, a * st, d};
  return out;
}

}  // namespace objdb::scene
