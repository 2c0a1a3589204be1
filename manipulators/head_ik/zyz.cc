#include "manipulators/head_ik/zyz.h"

#include <Eigen/Geometry>
#include <cmath>

namespace head {
namespace {

// below this the squares of r13 and r23 are lost in underflow, and with them the direction of the look axis
constexpr double underflow = 1e-140;

double sine_of_beta(const Eigen::Matrix3d& R) { return std::sqrt(R(2, 0) * R(2, 0) + R(2, 1) * R(2, 1)); }

Zyz by_half_angles(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  const double across = std::sqrt(q.x() * q.x() + q.y() * q.y()), along = std::sqrt(q.w() * q.w() + q.z() * q.z());
  const double sum = std::atan2(q.z(), q.w());
  // at the pole beta = 0 the difference is free, at beta = pi the sum is: alpha = 0 there, as in `zyz`
  const double difference = across < underflow ? -sum : std::atan2(-q.x(), q.y());
  if (along < underflow) return {0, 2 * std::atan2(across, along), -2 * difference};
  return {std::remainder(sum + difference, 2 * M_PI), 2 * std::atan2(across, along),
          std::remainder(sum - difference, 2 * M_PI)};
}

Zyz by_separate_angles(const Eigen::Matrix3d& R, double beta) {
  return {std::atan2(R(1, 2), R(0, 2)), beta, std::atan2(R(2, 1), -R(2, 0))};
}

Zyz at_the_pole_of_the_paper(const Eigen::Matrix3d& R) { return {0, 0, std::atan2(-R(0, 1), R(0, 0))}; }

}  // namespace

Eigen::Matrix3d rotation(const Zyz& angles) {
  const double ca = std::cos(angles.alpha), sa = std::sin(angles.alpha);
  const double cb = std::cos(angles.beta), sb = std::sin(angles.beta);
  const double cg = std::cos(angles.gamma), sg = std::sin(angles.gamma);
  Eigen::Matrix3d R;
  R << ca * cb * cg - sa * sg, -ca * cb * sg - sa * cg, ca * sb,  //
      sa * cb * cg + ca * sg, -sa * cb * sg + ca * cg, sa * sb,   //
      -sb * cg, sb * sg, cb;
  return R;
}

Zyz zyz(const Eigen::Matrix3d& R) {
  const double side = std::sqrt(R(0, 2) * R(0, 2) + R(1, 2) * R(1, 2));
  double alpha = 0, ca = 1, sa = 0;
  if (side > underflow) {
    alpha = std::atan2(R(1, 2), R(0, 2));
    ca = R(0, 2) / side;
    sa = R(1, 2) / side;
  }
  return {alpha, std::atan2(sine_of_beta(R), R(2, 2)),
          std::atan2(ca * R(1, 0) - sa * R(0, 0), ca * R(1, 1) - sa * R(0, 1))};
}

Zyz zyz(const Eigen::Matrix3d& R, ZyzRule rule) {
  const double r31 = R(2, 0), r32 = R(2, 1);
  switch (rule) {
    case ZyzRule::two_step: return zyz(R);
    case ZyzRule::half_angle: return by_half_angles(R);
    case ZyzRule::arc_cosine:
      if (r31 == 0 && r32 == 0) return at_the_pole_of_the_paper(R);
      return by_separate_angles(R, std::acos(std::fmin(1, std::fmax(-1, R(2, 2)))));
    case ZyzRule::not_both:
      if (r31 == 0 && r32 == 0) return at_the_pole_of_the_paper(R);
      return by_separate_angles(R, std::atan2(sine_of_beta(R), R(2, 2)));
    case ZyzRule::paper:
      if (r31 == 0 || r32 == 0) return at_the_pole_of_the_paper(R);
      return by_separate_angles(R, std::atan2(sine_of_beta(R), R(2, 2)));
  }
  return {};
}

std::string_view name_of(ZyzRule rule) {
  switch (rule) {
    case ZyzRule::two_step: return "two_step";
    case ZyzRule::half_angle: return "half_angle";
    case ZyzRule::arc_cosine: return "arc_cosine";
    case ZyzRule::not_both: return "not_both";
    case ZyzRule::paper: return "paper";
  }
  return "";
}

}  // namespace head
