#include "manipulators/face_fem/envelope.h"

namespace face {
namespace {

double step_up(double time, double begin, double length) {
  if (length <= 0) return time >= begin ? 1 : 0;
  return least_jerk((time - begin) / length);
}

}  // namespace

double least_jerk(double s) {
  if (s <= 0) return 0;
  if (s >= 1) return 1;
  return s * s * s * (10 + s * (6 * s - 15));
}

double Envelope::at(double time) const {
  const double up = step_up(time, begin, onset);
  return end == held ? up : up * (1 - step_up(time, end, offset));
}

}  // namespace face
