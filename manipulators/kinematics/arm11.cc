#include "manipulators/kinematics/arm11.h"

#include <numbers>

namespace kinematics {

namespace {

struct Line {
  double theta0, d, a, alpha, lower, upper, rest;  // degrees and metres
};

constexpr std::array<Line, 11> table = {{
    {0, 0, 0, 90, -65, -19, -33.486},
    {90, 0, 0, 90, 5, 30, 5.002},
    {90, 0.2077, 0.0282, 90, 0, 83, 32.914},
    {90, -0.0001, 0, 90, 33, 69, 45.571},
    {90, 0, 0, 90, -21.9, 20, 0.458},
    {-90, 0.0020, 0.0439, -90, -17, 18, -12.062},
    {-90, -0.0230, 0, 90, -90, 100, 43.864},
    {180, 0, 0, 90, -30, 84, -0.218},
    {90, -0.291128, 0.0049, -85.7834, -130, 90, -34.659},
    {177.4182, 0.014163, 0.007135, -93.7994, 5, 140, 5},
    {0, 0, 0, 0, 5, 160, 5},
}};

Pose base() {
  Pose X;
  X.R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  X.p << 0.0014, -0.0152, 0.0028;
  return X;
}

Pose tool() {
  Pose X;
  X.R << -0.011126, -0.043649, -0.998985, -0.983236, 0.182315, 0.002985, 0.182000, 0.982271, -0.044946;
  // the table has six decimals; the nearest rotation keeps the wrist rigid to rounding
  X.R = rotation_from_quaternion(quaternion(X.R));
  X.p << 0.001403, -0.009929, -0.243587;
  return X;
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Chain arm11(Side side, bool wide) {
  ChainBuilder builder(wide ? "arm11w" : "arm11");
  builder.fix(base());
  for (int i = 0; i < 11; ++i) {
    const Line& line = table[i];
    builder.dh(arm11_names[i], radians(line.theta0), line.d, line.a, radians(line.alpha), radians(line.lower),
               radians(line.upper), radians(line.rest));
  }
  builder.fix(tool());
  Chain arm = builder.finish();
  if (wide) {
    arm.joints[6].lower = radians(-170);
    arm.joints[6].upper = radians(175);
    arm.joints[8].lower = radians(-177);
    arm.joints[8].upper = radians(179);
  }
  return side == Side::left ? mirrored(arm) : arm;
}

Eigen::Matrix3d body_from_thorax() { return Eigen::Vector3d(-1, 1, -1).asDiagonal(); }

}  // namespace kinematics
